//! Sentences on faults of the data.

use files::format::significant;
use files::log::{Channel, Unit};
use pages::file_name;
use trace::AxisIdentification;
use trace::data_faults::{DataFault, FaultHandling, FaultKind};

/// One sentence for each fault of an axis; a fault of the same kind and size in several logs is stated once.
#[must_use]
pub fn of_axis(axis: &AxisIdentification) -> Vec<String> {
    let is_same = |a: &DataFault, b: &DataFault| {
        a.at_s.is_none() && DataFault { log: b.log.clone(), ..a.clone() } == *b
    };
    let faults = &axis.data_faults;
    let first =
        |&(number, fault): &(usize, &DataFault)| !faults[..number].iter().any(|other| is_same(other, fault));
    let sentence = |(_, fault): (usize, &DataFault)| {
        let logs = faults.iter().filter(|other| *other == fault || is_same(other, fault));
        let logs: Vec<&str> = logs.map(|fault| file_name(&fault.log)).collect();
        format!("{}: data fault in {}: {}.", axis.axis, logs.join(", "), description(fault, axis.unit))
    };
    faults.iter().enumerate().filter(first).map(sentence).collect()
}

/// What is wrong, and what the trace does about it.
fn description(fault: &DataFault, unit: Unit) -> String {
    let (position, size) = (if unit == Unit::Degree { "mdeg" } else { "µm" }, fault.size.unwrap_or(0.0));
    let what =
        fault.channel.map_or_else(|| "all channels".to_owned(), |channel| channel.word().replace('_', " "));
    let at_s = format!("{:.3}", fault.at_s.unwrap_or(0.0));
    let figure = significant(size.abs(), 3);
    let sign = if size < 0.0 { "−" } else { "+" };
    let (is, correction) = match fault.kind {
        FaultKind::Slip => (
            format!("the {what} reading slips by {sign}{figure} {position} at {at_s} s"),
            "the step is removed and both sides are used",
        ),
        FaultKind::Stuck => stuck(fault, &what, &at_s),
        FaultKind::Spike => (
            format!(
                "the {what} reading has {} {}, the largest of {sign}{figure} {position}, the first at {at_s} s",
                fault.count,
                if fault.count == 1 { "spike" } else { "spikes" }
            ),
            "it is left out there",
        ),
        FaultKind::Sign => (format!("the {what} reading has the wrong sign"), "it is used negated"),
        FaultKind::Exchanged => {
            (format!("the {what} reading is that of another axis"), "it is exchanged back")
        }
        FaultKind::Shifted => (
            format!("the {what} is logged {figure} ms {}", if size < 0.0 { "early" } else { "late" }),
            "it is shifted back",
        ),
        FaultKind::Rate => (
            format!("each row stands there {figure} times, so that the rate is lower than declared"),
            "it is not used",
        ),
        FaultKind::Unit => (
            format!(
                "the {what} is {} times what the other channels show: its unit or a factor is wrong",
                significant(size, 4)
            ),
            "it is converted",
        ),
        FaultKind::Hum => (hum(fault, unit), "it is subtracted"),
        FaultKind::Dead => (format!("the {what} does not change while the axis moves"), "it is not used"),
    };
    let treatment = match fault.treatment {
        FaultHandling::Corrected => correction,
        FaultHandling::Removed => "it is not used, and no effect is searched in the stages that need it",
        FaultHandling::LogLeftOut => "the log is not used",
    };
    format!("{is}; {treatment}")
}

/// A reading, or a whole row, that is repeated, and what the trace does about it.
fn stuck(fault: &DataFault, what: &str, at_s: &str) -> (String, &'static str) {
    let figure = significant(fault.size.unwrap_or(0.0).abs(), 3);
    match (fault.channel, fault.count) {
        (None, 1) => (
            format!("rows were lost and the row before them repeated for {figure} s from {at_s} s on"),
            "they are left out",
        ),
        (None, places) => (
            format!(
                "rows were lost and the rows before them repeated in {places} places, {figure} s in total, first at {at_s} s"
            ),
            "they are left out",
        ),
        (Some(_), count @ 2..) => (
            format!("the {what} reading is repeated {count} times, {figure} s in total, first at {at_s} s"),
            "it is left out there",
        ),
        (Some(_), _) => {
            (format!("the {what} reading is stuck for {figure} s from {at_s} s on"), "it is left out there")
        }
    }
}

/// The amplitude and the frequency of a hum.
fn hum(fault: &DataFault, unit: Unit) -> String {
    let unit = match (fault.channel, unit) {
        (Some(Channel::Force), Unit::Millimetre) => "N",
        (Some(Channel::Force), Unit::Degree) => "N·m",
        (_, Unit::Degree) => "mdeg",
        (_, Unit::Millimetre) => "µm",
    };
    let channel = fault.channel.map_or("all channels", Channel::word).replace('_', " ");
    let size = significant(fault.size.unwrap_or(0.0).abs(), 3);
    let hz = significant(fault.frequency_hz.unwrap_or(0.0), 4);
    format!("the {channel} reading has a hum of {size} {unit} at {hz} Hz")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(kind: FaultKind, size: Option<f64>, treatment: FaultHandling) -> DataFault {
        DataFault {
            axis: "x".to_owned(),
            channel: Some(Channel::Table),
            kind,
            log: "a/fit.csv".to_owned(),
            at_s: Some(16.846),
            size,
            frequency_hz: None,
            count: 1,
            treatment,
        }
    }

    #[test]
    fn a_fault_is_described_with_size_time_and_treatment() {
        let text =
            description(&fault(FaultKind::Slip, Some(-7.98), FaultHandling::Corrected), Unit::Millimetre);
        assert_eq!(
            text,
            "the table reading slips by −7.98 µm at 16.846 s; the step is removed and both sides are used"
        );
        let text = description(&fault(FaultKind::Unit, Some(1.6), FaultHandling::Removed), Unit::Millimetre);
        assert_eq!(
            text,
            "the table is 1.600 times what the other channels show: its unit or a factor is wrong; it is not used, and no \
             effect is searched in the stages that need it"
        );
        let twice = DataFault { count: 2, ..fault(FaultKind::Spike, Some(20.0), FaultHandling::Corrected) };
        let hum = DataFault {
            frequency_hz: Some(50.02),
            at_s: None,
            ..fault(FaultKind::Hum, Some(0.06), FaultHandling::Corrected)
        };
        assert_eq!(
            description(&hum, Unit::Millimetre),
            "the table reading has a hum of 0.0600 µm at 50.02 Hz; it is subtracted"
        );
        let stuck = DataFault { count: 90, ..fault(FaultKind::Stuck, Some(0.095), FaultHandling::Corrected) };
        assert_eq!(
            description(&DataFault { channel: None, ..stuck }, Unit::Millimetre),
            "rows were lost and the rows before them repeated in 90 places, 0.0950 s in total, first at 16.846 s; they are left out"
        );
        assert_eq!(
            description(&twice, Unit::Degree),
            "the table reading has 2 spikes, the largest of +20.0 mdeg, the first at 16.846 s; it is left out there"
        );
    }
}
