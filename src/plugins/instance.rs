//! What runs a plugin, whatever it is written in: a process, a library, a module.

use crate::bsdf::Transport;

/// The calls that carry numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// wi[n][3] → f[n][channels].
    Eval,
    /// wi[n][3] → pdf[n].
    Pdf,
    /// u[n][dimensions] → wi[n][3], weight[n][channels], pdf[n], flags[n].
    Sample,
}

impl Function {
    /// As it is called.
    pub fn word(self) -> &'static str {
        match self {
            Self::Eval => "eval",
            Self::Pdf => "pdf",
            Self::Sample => "sample",
        }
    }
}

/// A call of one of them: one wo, many rows.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    /// Which function.
    pub function: Function,
    /// Of which subject.
    pub handle: u64,
    /// In which mode.
    pub transport: Transport,
    /// The given direction.
    pub wo: [f64; 3],
    /// How many rows.
    pub rows: usize,
    /// Channels of the subject.
    pub channels: usize,
    /// wi or u, row-major.
    pub input: &'a [f64],
}

impl Call<'_> {
    /// How many numbers the answer has.
    pub fn answer(&self) -> usize {
        self.rows
            * match self.function {
                Function::Eval => self.channels,
                Function::Pdf => 1,
                Function::Sample => 5 + self.channels,
            }
    }
}

/// A subject that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Created {
    /// By which it is called.
    pub handle: u64,
    /// What `describe` says of it (JSON), if anything.
    pub describe: Option<String>,
}

/// Why a call was not answered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The plugin says so itself, and can be called again.
    #[error("{0}")]
    Refused(String),
    /// It crashed, hung or broke the protocol: the instance is gone.
    #[error("{0}")]
    Ended(String),
}

/// A running plugin, used by one thread at a time.
pub trait Instance: Send {
    /// The description of all its models (JSON).
    fn describe(&mut self) -> Result<String, Fault>;
    /// A subject of the model `model`, with `parameters` (a JSON object).
    fn create(&mut self, model: &str, parameters: &str) -> Result<Created, Fault>;
    /// Answers `call` into `answer`, which has [`Call::answer`] numbers.
    fn call(&mut self, call: &Call, answer: &mut [f64]) -> Result<(), Fault>;
    /// Gives a subject up.
    fn destroy(&mut self, handle: u64) -> Result<(), Fault>;
}
