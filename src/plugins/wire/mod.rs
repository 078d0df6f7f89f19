//! The two wires of programs: frames, and JSON lines.

mod frames;
mod json_lines;
mod reply;
mod serve;

pub use reply::Reply;
pub use serve::serve;

use super::instance::Call;
use serde_json::json;

/// How a program speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// Length, JSON header, arrays.
    Frames,
    /// A JSON object a line.
    JsonLines,
}

/// What is asked of a program.
pub enum Request<'a> {
    /// A subject of a model, with parameters (JSON).
    Create(&'a str, &'a str),
    /// Numbers.
    Call(&'a Call<'a>),
    /// The end of a subject.
    Destroy(u64),
}

impl Request<'_> {
    /// What it is called in messages.
    pub fn name(&self) -> String {
        match self {
            Self::Create(model, _) => format!("create() of `{model}`"),
            Self::Call(call) => format!("{}() of {} rows", call.function.word(), call.rows),
            Self::Destroy(_) => "destroy()".into(),
        }
    }

    /// Its object, without arrays.
    fn object(&self) -> serde_json::Value {
        match self {
            Self::Create(model, parameters) => {
                let parameters: serde_json::Value = serde_json::from_str(parameters).unwrap_or_default();
                json!({"call": "create", "model": model, "parameters": parameters})
            }
            Self::Call(call) => json!({
                "call": call.function.word(),
                "handle": call.handle,
                "mode": call.transport.to_string(),
                "wo": call.wo,
                "rows": call.rows,
            }),
            Self::Destroy(handle) => json!({"call": "destroy", "handle": handle}),
        }
    }
}

impl Wire {
    /// By the first bytes that a program writes; `None` where they are too few.
    pub fn of(first: &[u8]) -> Option<Self> {
        // 2^20 at most, a frame's length ends with a zero.
        (first.len() >= 4)
            .then(|| if first[0] == b'{' && first[3] != 0 { Self::JsonLines } else { Self::Frames })
    }

    /// The bytes that ask for it, in two parts: the second is lent.
    pub fn ask<'a>(self, request: &Request<'a>) -> (Vec<u8>, &'a [u8]) {
        match self {
            Self::Frames => frames::ask(request),
            Self::JsonLines => (json_lines::ask(request), &[]),
        }
    }

    /// Takes the text of an object off the front of what was read, with no arrays.
    pub fn take_text(self, read: &mut Vec<u8>) -> Result<Option<String>, String> {
        match self {
            Self::Frames => frames::take_text(read),
            Self::JsonLines => json_lines::take_line(read),
        }
    }

    /// Takes an answer off the front of what was read, its numbers into `answer`;
    /// `None` if it is not all there yet.
    pub fn take(
        self,
        read: &mut Vec<u8>,
        request: &Request,
        answer: &mut [f64],
    ) -> Result<Option<Reply>, String> {
        match self {
            Self::Frames => frames::take(read, answer),
            Self::JsonLines => json_lines::take(read, request, answer),
        }
    }
}
