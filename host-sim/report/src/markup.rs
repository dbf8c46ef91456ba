//! The few pieces of HTML that more than one section needs.

/// Text as it may stand between tags and in attributes. What stands between a number and its unit or
/// its uncertainty is no place for a line to end.
#[must_use]
pub fn text(plain: &str) -> String {
    let mut escaped = String::with_capacity(plain.len());
    let mut rest = plain.chars().peekable();
    let mut last = ' ';
    while let Some(c) = rest.next() {
        match c {
            ' ' if matches!(last, '±' | '−' | '+')
                || last.is_ascii_digit() && matches!(rest.peek(), Some('%' | 'µ' | '±')) =>
            {
                escaped.push_str("&nbsp;");
            }
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
        last = c;
    }
    escaped
}

/// A section with its heading; the body is markup. Nothing where the body is empty.
#[must_use]
pub fn section(heading: &str, body: &str) -> String {
    if body.is_empty() {
        String::new()
    } else {
        format!("<section>\n<h2>{}</h2>\n{body}</section>\n", text(heading))
    }
}

/// A paragraph of plain text.
#[must_use]
pub fn paragraph(plain: &str) -> String {
    format!("<p>{}</p>\n", text(plain))
}

/// A paragraph that explains what follows.
#[must_use]
pub fn note(plain: &str) -> String {
    format!("<p class=\"small\">{}</p>\n", text(plain))
}

/// A list of plain sentences.
#[must_use]
pub fn list(sentences: &[String]) -> String {
    let items: String = sentences.iter().map(|sentence| format!("<li>{}</li>\n", text(sentence))).collect();
    format!("<ul>\n{items}</ul>\n")
}

/// A picture with its caption in plain text.
#[must_use]
pub fn figure(class: &str, picture: &str, caption: &str) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    let caption = if caption.is_empty() {
        String::new()
    } else {
        format!("<figcaption>{}</figcaption>\n", text(caption))
    };
    format!("<figure{class}>\n{picture}{caption}</figure>\n")
}

/// An inline picture that tells a screen reader what it shows. The body is markup.
#[must_use]
pub fn svg((width, height): (u32, u32), title: &str, description: &str, body: &str) -> String {
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{}</title>\n<desc>{}</desc>\n{body}</svg>\n",
        text(title),
        text(description)
    )
}

/// One entry of a legend: a piece of line, or of surface, and what it stands for.
#[must_use]
pub fn key(class: &str, is_surface: bool, meaning: &str) -> String {
    let sample = if is_surface {
        format!("<rect class=\"{class}\" x=\"1\" y=\"2\" width=\"30\" height=\"8\"/>")
    } else {
        format!("<line class=\"{class}\" x1=\"0\" y1=\"6\" x2=\"32\" y2=\"6\"/>")
    };
    entry(&sample, meaning)
}

/// One entry of a legend: a point, and what it stands for.
#[must_use]
pub fn mark(class: &str, meaning: &str) -> String {
    entry(&format!("<circle class=\"{class}\" cx=\"16\" cy=\"6\" r=\"3\"/>"), meaning)
}

fn entry(sample: &str, meaning: &str) -> String {
    let meaning = text(meaning);
    format!(
        "<span class=\"key\"><svg viewBox=\"0 0 32 12\" aria-hidden=\"true\">{sample}</svg>{meaning}</span>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_a_text_is_text() {
        assert_eq!(text("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
        assert_eq!(text("3 ± 1 µm, 5 m"), "3&nbsp;±&nbsp;1&nbsp;µm, 5 m");
        assert_eq!(section("<", ""), "");
        assert!(figure("wide", "", "<script>").contains("&lt;script&gt;"));
    }
}
