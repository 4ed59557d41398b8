//! The part of HTTP/1.1 that the page needs: one request per connection, without a body. The one door of
//! `httparse`.

use std::borrow::Cow;
use std::io::{self, Read, Write};

/// Longest head of a request, bytes; browsers send about 1,000.
const MAX_HEAD: u64 = 16 << 10;
const MAX_HEADERS: usize = 64;

/// Rights of the page: to load what it is served with, and to ask its own server.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The head of a request.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    /// Of the address, what follows the host, without the query.
    pub(super) path: String,
    /// Text after `?`.
    pub(super) query: String,
    pub(super) host: Option<String>,
    /// The origin of the page that asks, if the browser names it.
    pub(super) origin: Option<String>,
}

impl Request {
    /// Reads a head; `None` when it is malformed.
    pub(super) fn read(from: &mut impl Read) -> io::Result<Option<Self>> {
        let mut from = from.take(MAX_HEAD);
        let (mut head, mut part) = (Vec::new(), [0; 2048]);
        loop {
            let count = from.read(&mut part)?;
            head.extend(&part[..count]);
            let ends = head.windows(4).any(|w| w == b"\r\n\r\n");
            if ends || count == 0 {
                return Ok(Self::parse(&head));
            }
        }
    }

    fn parse(head: &[u8]) -> Option<Self> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        request
            .parse(head)
            .ok()
            .filter(|status| status.is_complete())?;
        let (path, query) = request.path?.split_once('?').unwrap_or((request.path?, ""));
        let header = |name: &str| {
            let mut found = request
                .headers
                .iter()
                .filter(|h| h.name.eq_ignore_ascii_case(name));
            let text = str::from_utf8(found.next()?.value).ok()?;
            Some(text.to_owned())
        };
        Some(Self {
            method: request.method?.to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            host: header("host"),
            origin: header("origin"),
        })
    }

    /// The whole number that the query gives for `key`.
    pub(super) fn number(&self, key: &str) -> Option<u64> {
        let mut pairs = self
            .query
            .split('&')
            .filter_map(|pair| pair.split_once('='));
        pairs.find(|(name, _)| *name == key)?.1.parse().ok()
    }
}

/// An answer to a request.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Response {
    status: &'static str,
    kind: &'static str,
    /// The name that the answer is to be saved under.
    file: Option<&'static str>,
    body: Cow<'static, [u8]>,
}

impl Response {
    pub(super) fn of(kind: &'static str, body: impl Into<Cow<'static, [u8]>>) -> Self {
        Self {
            status: "200 OK",
            kind,
            file: None,
            body: body.into(),
        }
    }

    pub(super) fn refusal(status: &'static str) -> Self {
        Self {
            status,
            ..Self::of("text/plain", status.as_bytes())
        }
    }

    /// This answer, to be saved as `name`.
    pub(super) fn saved_as(self, name: &'static str) -> Self {
        Self {
            file: Some(name),
            ..self
        }
    }

    pub(super) fn write(&self, to: &mut impl Write) -> io::Result<()> {
        let Self { status, kind, .. } = self;
        let mut head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\n\
             Connection: close\r\nCache-Control: no-store\r\nContent-Security-Policy: {POLICY}\r\n\
             Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n",
            self.body.len()
        );
        if let Some(name) = self.file {
            head += &format!("Content-Disposition: attachment; filename=\"{name}\"\r\n");
        }
        head += "\r\n";
        to.write_all(head.as_bytes())?;
        to.write_all(&self.body)?;
        to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<Request> {
        Request::read(&mut text.as_bytes()).unwrap()
    }

    #[test]
    fn a_head_is_taken_apart() {
        let request =
            read("GET /a/state?seen=12&x=y HTTP/1.1\r\nhost: h:1\r\nOrigin: o\r\n\r\nrest")
                .unwrap();
        assert_eq!((&*request.method, &*request.path), ("GET", "/a/state"));
        assert_eq!(request.host.as_deref(), Some("h:1"));
        assert_eq!(request.origin.as_deref(), Some("o"));
        assert_eq!(
            (
                request.number("seen"),
                request.number("x"),
                request.number("y")
            ),
            (Some(12), None, None)
        );
    }

    #[test]
    fn what_is_no_request_is_none() {
        let long = format!("GET / HTTP/1.1\r\nX: {}", "x".repeat(1 << 20));
        for text in ["", "GET / HTTP/1.1\r\n", "hello\r\n\r\n", &long] {
            assert_eq!(read(text), None, "{:.40}", text);
        }
    }

    #[test]
    fn answers_say_how_long_they_are() {
        let mut bytes = Vec::new();
        let response = Response::of("image/svg+xml", b"<svg/>".as_slice()).saved_as("a.svg");
        response.write(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("HTTP/1.1 200 OK\r\n") && text.ends_with("\r\n\r\n<svg/>"));
        assert!(text.contains("Content-Length: 6\r\n") && text.contains("filename=\"a.svg\""));
    }
}
