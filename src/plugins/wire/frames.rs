//! Frames: four bytes of length, a JSON header, arrays of f64.

use super::reply::shown;
use super::{Reply, Request};

/// The longest header.
pub(super) const LONGEST: usize = 1 << 20;

/// A frame without arrays' bytes.
pub(super) fn head(header: &str) -> Vec<u8> {
    let mut frame = Vec::with_capacity(4 + header.len());
    frame.extend_from_slice(&(header.len() as u32).to_le_bytes());
    frame.extend_from_slice(header.as_bytes());
    frame
}

pub(super) fn ask<'a>(request: &Request<'a>) -> (Vec<u8>, &'a [u8]) {
    let payload: &[u8] =
        if let Request::Call(call) = request { bytemuck::cast_slice(call.input) } else { &[] };
    let mut object = request.object();
    object["bytes"] = payload.len().into();
    (head(&object.to_string()), payload)
}

/// The header of the frame that `read` begins with, and where its arrays start.
fn header(read: &[u8]) -> Result<Option<(&str, usize)>, String> {
    let Some(length) = read.first_chunk::<4>() else { return Ok(None) };
    let length = u32::from_le_bytes(*length) as usize;
    if !(2..=LONGEST).contains(&length) {
        return Err(garbage(read));
    }
    let Some(header) = read.get(4..4 + length) else {
        // Text that happens to begin like a length.
        return if read.len() > 4 && read[4] != b'{' { Err(garbage(read)) } else { Ok(None) };
    };
    let header = std::str::from_utf8(header).map_err(|_| garbage(read))?;
    if !header.starts_with('{') {
        return Err(garbage(read));
    }
    Ok(Some((header, 4 + length)))
}

/// What bytes say that are no frame.
fn garbage(read: &[u8]) -> String {
    // Its first line: frames may follow.
    let line = read.iter().position(|b| *b == b'\n').unwrap_or(read.len());
    let begin = String::from_utf8_lossy(&read[..line.min(16)]);
    // A character may be cut at the end.
    let begin = begin.trim_end_matches('\u{fffd}');
    if !begin.is_empty() && begin.chars().all(|c| c != '\u{fffd}' && (!c.is_control() || c == '\t')) {
        format!(
            "it wrote `{}` to standard output, where its answers go; it should print to standard error",
            shown(&read[..line])
        )
    } else {
        let hex: Vec<String> = read.iter().take(12).map(|b| format!("{b:02x}")).collect();
        format!("it wrote the bytes {} where a frame should begin", hex.join(" "))
    }
}

/// The text of a frame without arrays.
pub(super) fn take_text(read: &mut Vec<u8>) -> Result<Option<String>, String> {
    let Some((text, start)) = header(read)? else { return Ok(None) };
    let (text, bytes) = (text.to_string(), Reply::read(text)?.bytes);
    if bytes != 0 {
        return Err(format!("{bytes} bytes follow a header that has no arrays"));
    }
    read.drain(..start);
    Ok(Some(text))
}

pub(super) fn take(read: &mut Vec<u8>, answer: &mut [f64]) -> Result<Option<Reply>, String> {
    let Some((text, start)) = header(read)? else { return Ok(None) };
    let reply = Reply::read(text)?;
    let due = if reply.error.is_some() { 0 } else { size_of_val(answer) };
    if reply.bytes != due as u64 {
        let (got, wanted) = (reply.bytes / 8, due / 8);
        return Err(format!("it answered with {got} numbers ({} bytes) where {wanted} are due", reply.bytes));
    }
    let Some(bytes) = read.get(start..start + due) else { return Ok(None) };
    if due > 0 {
        bytemuck::cast_slice_mut(answer).copy_from_slice(bytes);
    }
    if read.len() == start + due {
        read.clear();
    } else {
        read.drain(..start + due);
    }
    Ok(Some(reply))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(header: &str, numbers: &[f64]) -> Vec<u8> {
        let mut frame = head(header);
        frame.extend_from_slice(bytemuck::cast_slice(numbers));
        frame
    }

    #[test]
    fn an_answer_may_come_in_any_pieces() {
        let whole = frame(r#"{"bytes":16}"#, &[1.5, f64::NAN]);
        let mut answer = [0.0; 2];
        for cut in 0..whole.len() {
            let mut read = whole[..cut].to_vec();
            assert!(take(&mut read, &mut answer).unwrap().is_none(), "{cut}");
            read.extend_from_slice(&whole[cut..]);
            assert!(take(&mut read, &mut answer).unwrap().is_some() && read.is_empty(), "{cut}");
            assert!(answer[0] == 1.5 && answer[1].is_nan());
        }
    }

    #[test]
    fn what_is_no_frame_is_told() {
        let wrong = |read: &[u8], numbers: usize| {
            let found = take(&mut read.to_vec(), &mut vec![0.0; numbers]);
            found.err().unwrap_or_else(|| panic!("{read:?}"))
        };
        assert!(wrong(b"Hello, world\n", 1).contains("`Hello, world` to standard output"));
        assert!(wrong("debugging…\n\x10\0\0\0{".as_bytes(), 1).contains("`debugging…` to"));
        assert!(wrong(b"\0\0\0\0xxxx", 1).contains("00 00 00 00 78"));
        assert!(wrong(&frame(r#"{"bytes":8}"#, &[1.0]), 2).contains("1 numbers (8 bytes) where 2 are due"));
        assert!(wrong(&frame("[]", &[]), 1).contains("frame"));
        assert!(wrong(&frame("{nonsense}", &[]), 1).contains("nonsense"));
        // 10 and "  x" make a plausible length.
        assert!(wrong(b"\n\0\0\0Hello, world", 1).contains("frame should begin"));
    }

    #[test]
    fn an_error_has_no_numbers() {
        let mut read = frame(r#"{"error":"no table","bytes":0}"#, &[]);
        assert_eq!(take(&mut read, &mut [0.0; 3]).unwrap().unwrap().error.as_deref(), Some("no table"));
    }
}
