//! The standard input and output of a confined program, which go by bubblewrap: it would
//! hold them open after the program has closed them. What it is started with as standard
//! input is a socket to the guard, and they come over that.

use rustix::net::{
    AddressFamily, RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, SocketFlags, SocketType, recvmsg, sendmsg, socketpair,
};
use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};

/// Longest message.
const MESSAGE: usize = 256;

/// Two ends that keep messages apart.
pub fn pair() -> io::Result<(OwnedFd, OwnedFd)> {
    Ok(socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None)?)
}

/// Sends a message with up to two open files.
pub fn send(to: impl AsFd, message: &str, files: &[BorrowedFd]) -> io::Result<()> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(2))];
    let mut with = SendAncillaryBuffer::new(&mut space);
    if !files.is_empty() && !with.push(SendAncillaryMessage::ScmRights(files)) {
        return Err(io::Error::other("too many files for one message"));
    }
    let bytes = &message.as_bytes()[..message.len().min(MESSAGE)];
    sendmsg(to, &[IoSlice::new(bytes)], &mut with, SendFlags::NOSIGNAL)?;
    Ok(())
}

/// The next message and its files; an empty one where the other end is gone.
pub fn receive(from: impl AsFd) -> io::Result<(String, Vec<OwnedFd>)> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(2))];
    let mut with = RecvAncillaryBuffer::new(&mut space);
    let mut bytes = [0; MESSAGE];
    let got = recvmsg(from, &mut [IoSliceMut::new(&mut bytes)], &mut with, RecvFlags::CMSG_CLOEXEC)?;
    let mut files = Vec::new();
    for message in with.drain() {
        if let RecvAncillaryMessage::ScmRights(more) = message {
            files.extend(more);
        }
    }
    Ok((String::from_utf8_lossy(&bytes[..got.bytes]).into_owned(), files))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn files_go_over() {
        let (ours, theirs) = pair().unwrap();
        let (mut one, two) = std::io::pipe().map(|(read, write)| (write, read)).unwrap();
        send(&ours, "two", &[one.as_fd(), two.as_fd()]).unwrap();
        send(&ours, "none", &[]).unwrap();
        drop(ours);
        let (message, files) = receive(&theirs).unwrap();
        assert_eq!((message.as_str(), files.len()), ("two", 2));
        assert_eq!(receive(&theirs).unwrap().0, "none");
        assert!(receive(&theirs).unwrap().0.is_empty());
        one.write_all(b"x").unwrap();
        let mut byte = [0];
        rustix::io::read(&files[1], &mut byte).unwrap();
        assert_eq!(&byte, b"x");
    }
}
