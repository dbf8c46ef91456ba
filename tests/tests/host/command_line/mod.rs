//! The command line: exit codes, one-line errors, complete outputs.

mod accepted;
mod board_arguments;
mod certificate;
mod circle;
mod compare;
mod compensate;
mod foreign_logs;
mod history;
mod import;
mod import_formats;
mod improve;
mod init;
mod margins;
mod other_controls;
mod positions;
mod refused;
mod refused_lost_motion;
mod reproduce;
mod resonances;
mod sensors;
mod stopped;
mod sturdy;
mod tune;
mod verify;
mod work_folder;
mod worked_example;
