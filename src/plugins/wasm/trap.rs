//! Why a module stopped, in words.

use wasmi::TrapCode;
use wasmi::errors::ErrorKind;

/// What the module did, as the rest of a sentence that begins with it.
pub fn told(error: &wasmi::Error) -> String {
    if let Some(code) = error.as_trap_code() {
        return of_code(code).to_owned();
    }
    match error.kind() {
        ErrorKind::I32ExitStatus(status) => format!("called exit({status})"),
        ErrorKind::Message(message) => message.to_string(),
        _ => format!("was stopped: {error}"),
    }
}

fn of_code(code: TrapCode) -> &'static str {
    match code {
        TrapCode::UnreachableCodeReached => "executed `unreachable` (a panic or an assertion)",
        TrapCode::MemoryOutOfBounds => "read or wrote outside its memory",
        TrapCode::TableOutOfBounds => "called a function pointer that is outside its table",
        TrapCode::IndirectCallToNull => "called a function pointer that is null",
        TrapCode::BadSignature => "called a function pointer as a function of another type",
        TrapCode::IntegerDivisionByZero => "divided by zero",
        TrapCode::IntegerOverflow => "divided the smallest integer by -1",
        TrapCode::BadConversionToInteger => "converted to an integer what is none (NaN, or too large)",
        TrapCode::StackOverflow => "recursed without end",
        TrapCode::OutOfFuel => "looped without end",
        TrapCode::GrowthOperationLimited => "wanted more memory or tables than it may have",
        _ => "was stopped by a trap that gonio does not know",
    }
}
