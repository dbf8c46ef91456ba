//! `lost-motion completions` and `lost-motion man`: what a shell and its manual know of the program.

use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Command;
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use super::outputs::print;
use files::output::{create_folder, write_whole};

/// Arguments of `completions`.
#[derive(clap::Args)]
pub struct CompletionArguments {
    /// The shell.
    shell: Shell,
}

/// Prints the completions for a shell.
///
/// # Errors
/// If stdout cannot be written.
pub fn completions(arguments: &CompletionArguments, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    let name = command.get_name().to_owned();
    generate(arguments.shell, &mut command, name, &mut script);
    // As it is: a script may have characters that a terminal does not show. A closed pipe is not an error.
    match stdout().lock().write_all(&script) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

/// Arguments of `man`.
#[derive(clap::Args)]
pub struct ManArguments {
    /// Folder for the pages; made if it is missing.
    #[arg(long, value_name = "DIR")]
    out_dir: PathBuf,
}

/// Writes a page for the program and for each verb.
///
/// # Errors
/// If a page cannot be written.
pub fn man(arguments: &ManArguments, command: Command) -> Result<()> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    create_folder(&arguments.out_dir)?;
    let pages = pages_of(&command, &arguments.out_dir)?;
    print(&format!("{pages} pages: {}", arguments.out_dir.display()))
}

/// Writes the pages of a command and of its verbs, and counts them.
fn pages_of(command: &Command, folder: &Path) -> Result<usize> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    write_whole(&folder.join(man.get_filename()), |out| out.write_all(&page))?;
    let mut count = 1;
    for verb in command.get_subcommands() {
        count += pages_of(verb, folder)?;
    }
    Ok(count)
}
