//! The consent to a motion: `--yes`, or a key on a terminal.

use std::io::{BufRead, IsTerminal, Write, stderr, stdin};

use anyhow::{Result, bail};
use files::error::InputError;

/// Returns if the user agrees to what is going to move. `what` is a sentence without its full stop.
///
/// # Errors
/// No terminal that could be asked, another answer than Enter.
pub fn ask(what: &str, yes: bool) -> Result<()> {
    if yes {
        return Ok(());
    }
    if !(stdin().is_terminal() && stderr().is_terminal()) {
        let problem = format!("expected this flag, or a terminal to ask at: {what}");
        return Err(InputError::new("--yes", problem).into());
    }
    if !agrees(what, &mut stdin().lock(), &mut stderr().lock())? {
        bail!("not started: nothing has moved");
    }
    Ok(())
}

/// Whether the answer is Enter. The end of the answers is none.
fn agrees(what: &str, answers: &mut impl BufRead, terminal: &mut impl Write) -> std::io::Result<bool> {
    write!(terminal, "{what}.\nA hand on the enable switch? Enter starts it, anything else does not: ")?;
    terminal.flush()?;
    let mut line = String::new();
    Ok(answers.read_line(&mut line)? > 0 && line.trim().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enter_agrees_and_nothing_else_does() {
        for (answer, expected) in
            [("\n", true), ("\r\n", true), ("", false), ("n\n", false), ("yes\n", false)]
        {
            let mut terminal = Vec::new();
            assert_eq!(
                agrees("x moves", &mut answer.as_bytes(), &mut terminal).unwrap(),
                expected,
                "{answer:?}"
            );
            assert!(String::from_utf8(terminal).unwrap().starts_with("x moves.\n"));
        }
    }
}
