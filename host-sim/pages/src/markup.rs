//! HTML elements that several sections of a page use; maud escapes all text.

use maud::{Markup, PreEscaped, html};

/// Plain text in an element or attribute. The spaces between a number and its unit or uncertainty
/// become no-break spaces (U+00A0).
#[must_use]
pub fn text(plain: &str) -> Markup {
    const NO_BREAK_SPACE: char = '\u{a0}';
    let mut spaced = String::with_capacity(plain.len());
    let mut remaining = plain.chars().peekable();
    let mut last = ' ';
    while let Some(c) = remaining.next() {
        let is_in_quantity = matches!(last, '±' | '−' | '+')
            || last.is_ascii_digit() && matches!(remaining.peek(), Some('%' | 'µ' | '±'));
        spaced.push(if c == ' ' && is_in_quantity { NO_BREAK_SPACE } else { c });
        last = c;
    }
    html! { (spaced) }
}

/// A section with its heading; empty if the body is empty.
#[must_use]
pub fn section(heading: &str, body: &Markup) -> Markup {
    html! {
        @if !body.0.is_empty() {
            section { h2 { (text(heading)) } (body) }
        }
    }
}

/// A paragraph of plain text.
#[must_use]
pub fn paragraph(plain: &str) -> Markup {
    html! { p { (text(plain)) } }
}

/// A paragraph that explains the following content.
#[must_use]
pub fn note(plain: &str) -> Markup {
    html! { p.small { (text(plain)) } }
}

/// A list of plain sentences.
#[must_use]
pub fn list(sentences: &[String]) -> Markup {
    html! {
        ul {
            @for sentence in sentences { li { (text(sentence)) } }
        }
    }
}

/// A column of a [`table`], with its heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Words, aligned left.
    Words(&'static str),
    /// Numbers, aligned right.
    Numbers(&'static str),
}

/// A table with one row of headings; the rows are markup. The caption is read by screen readers and is the name of the saved file.
#[must_use]
pub fn table(caption: &str, columns: &[Column], rows: &Markup) -> Markup {
    let head = html! {
        tr {
            @for column in columns {
                @match column {
                    // A column of pictures has no heading.
                    Column::Words("") => td {},
                    Column::Words(heading) => th scope="col" { (heading) },
                    Column::Numbers(heading) => th.n scope="col" { (heading) },
                }
            }
        }
    };
    table_with("", caption, &html! { thead { (head) } tbody { (rows) } })
}

/// A table of any parts, which scrolls by itself where it is wider than the page, also by keyboard.
#[must_use]
pub fn table_with(class: &str, caption: &str, parts: &Markup) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label=(caption) {
            table class=[(!class.is_empty()).then_some(class)] {
                caption.unseen { (text(caption)) }
                (parts)
            }
        }
    }
}

/// Content that is folded away under a line of plain text; empty if there is none.
#[must_use]
pub fn folded(summary: &str, body: &Markup) -> Markup {
    html! {
        @if !body.0.is_empty() {
            details { summary { (text(summary)) } (body) }
        }
    }
}

/// Text that keeps its spaces and lines, such as columns of a terminal; it scrolls by itself where it is wider than the page, also by
/// keyboard. The label is read by screen readers.
#[must_use]
pub fn preformatted(label: &str, lines: &str) -> Markup {
    html! { pre.scroll tabindex="0" role="region" aria-label=(label) { (text(lines)) } }
}

/// A cell of a column of words. Where its text is as long as a sentence, the column keeps room for several words.
#[must_use]
pub fn words_cell(shown: &str) -> Markup {
    /// Characters that fit into a column as wide as a few headings.
    const SHORT: usize = 30;
    let is_sentence = shown.chars().count() > SHORT;
    html! { td class=[is_sentence.then_some("sentence")] { (text(shown)) } }
}

/// A cell of a column of numbers.
#[must_use]
pub fn number_cell(shown: &str) -> Markup {
    html! { td.n { (text(shown)) } }
}

/// A picture (an SVG element) with its caption in plain text; without a class or caption if it is empty.
#[must_use]
pub fn figure(class: &str, picture: &str, caption: &str) -> Markup {
    html! {
        figure class=[(!class.is_empty()).then_some(class)] {
            (PreEscaped(picture))
            @if !caption.is_empty() {
                figcaption { (text(caption)) }
            }
        }
    }
}

/// What the script of a page needs to know of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attributes<'a> {
    /// The µm of a division, if it is a circle.
    pub division_um: Option<f64>,
    /// Its figures, if it has any; see `data`.
    pub figures: Option<&'a str>,
}

/// An SVG element with title and description for screen readers. The size is in units of the drawing; the page scales
/// it.
#[must_use]
pub fn svg(
    (width, height): (u32, u32),
    attributes: Attributes<'_>,
    (title, description): (&str, &str),
    body: &Markup,
) -> String {
    let Attributes { division_um, figures } = attributes;
    let element = html! {
        svg viewBox={ "0 0 " (width) " " (height) } role="img" data-division=[division_um] data-figures=[figures] {
            title { (text(title)) }
            desc { (text(description)) }
            (body)
        }
    };
    element.into_string()
}

/// The legend of a picture; empty without entries.
#[must_use]
pub fn legend(entries: &[Markup]) -> Markup {
    html! {
        @if !entries.is_empty() {
            p.legend {
                // The space allows a line break between two entries.
                @for entry in entries { (entry) " " }
            }
        }
    }
}

/// Legend entry of a line with a class of the stylesheet.
#[must_use]
pub fn line_entry(class: &str, meaning: &str) -> Markup {
    entry(&html! { line class=(class) x1="0" y1="6" x2="32" y2="6" {} }, meaning)
}

/// Legend entry of a surface with a class of the stylesheet.
#[must_use]
pub fn surface_entry(class: &str, meaning: &str) -> Markup {
    entry(&html! { rect class=(class) x="1" y="2" width="30" height="8" {} }, meaning)
}

/// Legend entry of a point with a class of the stylesheet.
#[must_use]
pub fn point_entry(class: &str, meaning: &str) -> Markup {
    entry(&html! { circle class=(class) cx="16" cy="6" r="3" {} }, meaning)
}

fn entry(sample: &Markup, meaning: &str) -> Markup {
    html! {
        span.key {
            svg viewBox="0 0 32 12" aria-hidden="true" { (sample) }
            (text(meaning))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_text_is_text() {
        assert_eq!(text("a<b> & \"c\" 'd'").0, "a&lt;b&gt; &amp; &quot;c&quot; 'd'");
        assert_eq!(text("3 ± 1 µm, 5 m").0, "3\u{a0}±\u{a0}1\u{a0}µm, 5 m");
        assert_eq!(section("<", &Markup::default()).0, "");
        assert!(figure("wide", "", "<script>").0.contains("&lt;script&gt;"));
        assert!(
            svg((1, 1), Attributes::default(), ("\"<", ""), &Markup::default())
                .contains("<title>&quot;&lt;</title>")
        );
        let entries = [line_entry("a\"b", "<"), surface_entry("a\"b", "<"), point_entry("a\"b", "<")];
        assert_eq!(legend(&entries).0.matches("class=\"a&quot;b\"").count(), 3);
        assert_eq!(legend(&entries).0.matches("&lt;</span> ").count(), 3);
        assert_eq!(legend(&[]).0, "");
    }

    /// The stylesheet keeps room for a sentence, not for a word.
    #[test]
    fn a_sentence_in_a_cell_has_its_room() {
        assert_eq!(words_cell("certain").0, "<td>certain</td>");
        let sentence = "compensate: half of the width after each reversal";
        assert_eq!(words_cell(sentence).0, format!("<td class=\"sentence\">{sentence}</td>"));
        assert!(crate::STYLE.contains(".sentence { min-width:"));
    }

    #[test]
    fn preformatted_text_scrolls_by_itself_and_is_escaped() {
        assert_eq!(
            preformatted("a < b", "a  <\nb").0,
            "<pre class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"a &lt; b\">a  &lt;\nb</pre>"
        );
    }

    #[test]
    fn nothing_is_folded_away_under_a_line_of_its_own() {
        assert_eq!(folded("more", &Markup::default()).0, "");
        assert_eq!(
            folded("<", &note("a")).0,
            "<details><summary>&lt;</summary><p class=\"small\">a</p></details>"
        );
    }

    #[test]
    fn a_table_has_a_heading_for_each_column() {
        let row = html! { tr { td { "a" } (number_cell("1 µm")) } };
        let table = table("a < b", &[Column::Words("name"), Column::Numbers("size")], &row);
        assert_eq!(
            table.0,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"a &lt; b\"><table>\
             <caption class=\"unseen\">a &lt; b</caption><thead><tr><th scope=\"col\">name</th><th class=\"n\" scope=\"col\">size</th></tr></thead>\
             <tbody><tr><td>a</td><td class=\"n\">1\u{a0}µm</td></tr></tbody></table></div>"
        );
    }
}
