//! Where a machine is measured, and the result.

use import::request::Request;
use std::fs;
use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use volume::analysis::Analysis;
use volume::survey::Survey;
use volume::{analyse, sources};

use super::machine::Machine;

/// Lines along the axes and circles in the three planes, at places; what is held out is elsewhere.
pub struct Places {
    lines: Vec<(usize, [f64; 3], bool)>,
    circles: Vec<([usize; 2], [f64; 3], bool)>,
}

pub fn survey(folder: &Path, machine: &Machine, places: &Places, seed: u64) -> Survey {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let names = ["x", "y", "z"];
    let chain = machine.chain.map(|axis| format!("\"{}\"", names[axis])).join(", ");
    let mut toml = format!("chain = [{chain}]\n");
    for (index, (axis, at_mm, is_held_out)) in places.lines.iter().enumerate() {
        let file = format!("line{index}.csv");
        fs::write(folder.join(&file), machine.positioning(*axis, *at_mm, &mut random)).unwrap();
        let others = (0..3).filter(|other| other != axis);
        let at = others
            .map(|other| format!("{} = {:.1}", names[other], at_mm[other]))
            .collect::<Vec<_>>()
            .join(", ");
        toml += &format!(
            "[[positioning]]\nfile = \"{file}\"\naxis = \"{}\"\nat_mm = {{ {at} }}\nvalidate = {is_held_out}\n",
            names[*axis]
        );
    }
    for (index, (plane, at_mm, is_held_out)) in places.circles.iter().enumerate() {
        let file = format!("circle{index}.csv");
        let radius_mm = if *is_held_out { 90.0 } else { 120.0 };
        fs::write(folder.join(&file), machine.circle(*plane, *at_mm, radius_mm, &mut random)).unwrap();
        let [x, y, z] = at_mm;
        toml += &format!(
            "[[circle]]\nfiles = [\"{file}\"]\nplane = [\"{}\", \"{}\"]\nat_mm = {{ x = {x:.1}, y = {y:.1}, z = {z:.1} }}\nradius_mm = {radius_mm:.1}\nvalidate = {is_held_out}\n",
            names[plane[0]], names[plane[1]]
        );
    }
    Survey::parse(&toml, &folder.join("survey.toml")).unwrap()
}

/// A line of each axis and a circle in each plane: the least that shows positioning, squareness and straightness.
pub fn few() -> Places {
    let middle = [250.0, 200.0, -150.0];
    Places {
        lines: (0..3).map(|axis| (axis, middle, false)).collect(),
        circles: [[0, 1], [0, 2], [1, 2]].map(|plane| (plane, middle, false)).to_vec(),
    }
}

/// Three lines, each at a place of its own, and circles about one centre: tilts are open, and with them some squareness; positioning is that of
/// the line.
pub fn apart() -> Places {
    let lines = [[0.0, 50.0, -30.0], [100.0, 0.0, -200.0], [400.0, 300.0, 0.0]];
    let lines = (0..3).map(|axis| (axis, lines[axis], false)).collect();
    Places { lines, ..few() }
}

/// Lines at several places and circles at both ends of the third axis.
pub fn many() -> Places {
    let middle = [250.0, 200.0, -150.0];
    let mut places = few();
    for (axis, other, mm) in
        [(0, 1, 30.0), (0, 2, -20.0), (1, 0, 40.0), (1, 2, -280.0), (2, 0, 450.0), (2, 1, 370.0)]
    {
        let mut at_mm = middle;
        at_mm[other] = mm;
        places.lines.push((axis, at_mm, false));
    }
    for (plane, third, both_mm) in
        [([0, 1], 2, [-280.0, -20.0]), ([0, 2], 1, [30.0, 370.0]), ([1, 2], 0, [30.0, 470.0])]
    {
        for mm in both_mm {
            let mut at_mm = middle;
            at_mm[third] = mm;
            places.circles.push((plane, at_mm, false));
        }
    }
    places.lines.push((0, [250.0, 60.0, -60.0], true));
    // Within the positions at which the straightness was seen: beyond them the tables hold the last value.
    places.circles.push(([0, 1], [275.0, 220.0, -80.0], true));
    places
}

pub fn analysed(machine: &Machine, places: &Places, seed: u64) -> Analysis {
    let folder = tempfile::tempdir().unwrap();
    let survey = survey(folder.path(), machine, places, seed);
    analyse(survey.chain, sources::read(&survey, &Request::default()).unwrap()).unwrap()
}

/// The rms over the volume of true errors, µm, and of what the result leaves of them. A displacement and a turn of the whole machine are
/// fitted to each and removed: no measurement between tool and workpiece shows them.
pub fn before_and_after_um(machine: &Machine, analysis: &Analysis) -> [f64; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(99);
    // The volume that was measured, without its outermost tenth, where polynomials of a low degree end.
    let points: Vec<[f64; 3]> = (0..400)
        .map(|_| {
            [0, 1, 2].map(|axis| {
                let [low, high] = analysis.measured_mm[axis];
                low + (high - low) * random.random_range(0.1..0.9)
            })
        })
        .collect();
    let errors = |is_after: bool| -> Vec<[f64; 3]> {
        let of = |at_mm: &[f64; 3]| {
            let (truth, known) = (machine.error_um(*at_mm), analysis.error_um(*at_mm));
            [0, 1, 2].map(|axis| truth[axis] - if is_after { known[axis] } else { 0.0 })
        };
        points.iter().map(of).collect()
    };
    [false, true].map(|is_after| {
        let errors = errors(is_after);
        let matrix = nalgebra::DMatrix::from_fn(3 * points.len(), 6, |row, column| {
            let (at_mm, axis) = (points[row / 3], row % 3);
            match column {
                0..=2 => f64::from(u8::from(column == axis)),
                3 => [0.0, -at_mm[2], at_mm[1]][axis],
                4 => [at_mm[2], 0.0, -at_mm[0]][axis],
                _ => [-at_mm[1], at_mm[0], 0.0][axis],
            }
        });
        let values = nalgebra::DVector::from_iterator(3 * points.len(), errors.into_iter().flatten());
        let solved = matrix.clone().svd(true, true).solve(&values, 1e-12).unwrap();
        ((values - matrix * solved).norm_squared() / points.len() as f64).sqrt()
    })
}
