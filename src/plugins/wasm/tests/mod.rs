//! Modules written as text: good ones, and one for each way to go wrong.

mod files;
mod hostile;
mod imports;
mod lambert;
mod shell;
