//! Where things stand in a RON text: lines, columns, and the value of each field.
//!
//! RON's own errors know a position but not the field, and a value out of range is found after parsing, when
//! its position is gone. [`Source`] finds both, in a loop and with bounded memory, whatever the text.

use core::ops::Range;

use super::{FileError, Place};
use crate::limits;

/// A RON text and the file it came from.
pub(crate) struct Source<'a> {
    text: &'a str,
    file: &'a str,
}

/// A field's value, or an element of a list that is itself a structure.
#[derive(Debug)]
pub(crate) struct Entry<'a> {
    parent: Option<usize>,
    key: Key<'a>,
    /// Bytes of its value.
    pub span: Range<usize>,
    words: u32,
    groups: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Key<'a> {
    Name(&'a str),
    Index(u32),
}

impl Entry<'_> {
    /// Whether its value is one word or one bracketed group (with a name before it), not several run together.
    pub fn is_single(&self) -> bool {
        self.words <= 1 && self.groups <= 1
    }
}

impl<'a> Source<'a> {
    pub fn new(text: &'a str, file: &'a str) -> Self {
        Self { text, file }
    }

    /// The place of a byte of the text.
    pub fn place(&self, offset: usize) -> Place {
        let before = &self.text[..self.text.floor_char_boundary(offset)];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        Place {
            file: self.file.into(),
            line: Some(before.matches('\n').count() as u32 + 1),
            column: Some(before[line_start..].chars().count() as u32 + 1),
        }
    }

    /// The byte at a line and column, both from 1.
    pub fn offset(&self, line: usize, column: usize) -> usize {
        let start: usize = self.text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let rest = &self.text[start..];
        start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(i, _)| i)
    }

    /// The first byte from here on that is no white space.
    pub fn skip_space(&self, offset: usize) -> usize {
        self.text.len() - self.text[offset..].trim_start().len()
    }

    /// The text of a value.
    pub fn value(&self, entry: &Entry) -> &'a str {
        &self.text[entry.span.clone()]
    }

    /// Checks that there is something in it and that brackets are not nested too deep.
    pub fn check(&self) -> Result<(), FileError> {
        let mut depth = 0usize;
        let mut any = false;
        let mut tokens = Tokens::new(self.text);
        for token in tokens.by_ref() {
            any = true;
            match token.kind {
                Kind::Open(_) => depth += 1,
                Kind::Close => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth > limits::NESTING {
                return Err(FileError::TooDeep { at: self.place(token.span.start), limit: limits::NESTING });
            }
        }
        if any {
            return Ok(());
        }
        let what = match self.text.trim() {
            "" => "the file is empty",
            _ if tokens.unclosed => "a `/*` is never closed by `*/`",
            _ => "the file holds nothing but comments",
        };
        Err(FileError::Syntax {
            at: Place::file(self.file),
            message: format!("{what}; the least there can be is `()`"),
        })
    }

    /// Every value down to a depth of brackets, outer ones before those inside them.
    pub fn entries(&self, depth: usize) -> Vec<Entry<'a>> {
        let mut map = Map {
            text: self.text,
            depth,
            entries: Vec::new(),
            frames: vec![Frame::new(b'\0', None)],
            last: 0,
        };
        let mut tokens = Tokens::new(self.text).peekable();
        while let Some(token) = tokens.next() {
            let named = token.kind == Kind::Word && tokens.peek().is_some_and(|t| t.kind == Kind::Colon);
            let opens =
                token.kind != Kind::Word || tokens.peek().is_some_and(|t| matches!(t.kind, Kind::Open(_)));
            if map.token(&token, named, opens) {
                tokens.next();
            }
        }
        map.finish()
    }

    /// The innermost value at a byte of the text.
    pub fn at(entries: &[Entry<'a>], offset: usize) -> Option<usize> {
        entries.iter().rposition(|e| e.span.start <= offset && offset <= e.span.end)
    }

    /// The names that lead to a value; an element of a list is `[i]`.
    pub fn path(entries: &[Entry<'a>], mut index: usize) -> Vec<String> {
        let mut path = Vec::new();
        loop {
            path.push(match entries[index].key {
                Key::Name(name) => name.into(),
                Key::Index(i) => format!("[{i}]"),
            });
            match entries[index].parent {
                Some(parent) => index = parent,
                None => break,
            }
        }
        path.reverse();
        path
    }

    /// The value at the end of a path, or the last one on the way there.
    pub fn find(entries: &[Entry<'a>], path: &[String]) -> Option<usize> {
        let mut found = None;
        for name in path {
            let next = entries.iter().position(|e| {
                e.parent == found
                    && match e.key {
                        Key::Name(n) => n == name,
                        Key::Index(i) => *name == format!("[{i}]"),
                    }
            });
            match next {
                Some(next) => found = Some(next),
                None => break,
            }
        }
        found
    }

    /// Where the value at the end of a path stands, as far as the text has it.
    pub fn place_of(&self, path: &[String]) -> Place {
        let entries = self.entries(limits::NESTING);
        match Self::find(&entries, path) {
            Some(i) => self.place(entries[i].span.start),
            None => Place::file(self.file),
        }
    }

    /// The value at the end of a path as written, `None` if the text does not have it.
    pub fn written(&self, path: &[String]) -> Option<&'a str> {
        let entries = self.entries(limits::NESTING);
        let i = Self::find(&entries, path)?;
        (Self::path(&entries, i) == path).then(|| self.value(&entries[i]))
    }
}

/// Splits `lamps[0].strength` into `lamps`, `[0]`, `strength`.
pub(crate) fn split_path(path: &str) -> Vec<String> {
    path.split('.')
        .flat_map(|part| match part.find('[') {
            Some(i) if i > 0 => vec![part[..i].to_string(), part[i..].to_string()],
            _ => vec![part.to_string()],
        })
        .collect()
}

/// Joins `lamps`, `[0]`, `strength` into `lamps[0].strength`.
pub(crate) fn join_path(path: &[String]) -> String {
    let mut joined = String::new();
    for name in path {
        if !joined.is_empty() && !name.starts_with('[') {
            joined.push('.');
        }
        joined.push_str(name);
    }
    joined
}

struct Frame<'a> {
    bracket: u8,
    /// The value whose brackets these are.
    owner: Option<usize>,
    key: Option<&'a str>,
    /// The value being read, if one has begun; the second says whether it is an entry of its own.
    value: Option<(Option<usize>, bool)>,
    index: u32,
}

impl Frame<'_> {
    fn new(bracket: u8, owner: Option<usize>) -> Self {
        Self { bracket, owner, key: None, value: None, index: 0 }
    }
}

struct Map<'a> {
    text: &'a str,
    depth: usize,
    entries: Vec<Entry<'a>>,
    frames: Vec<Frame<'a>>,
    /// End of the token before.
    last: usize,
}

impl<'a> Map<'a> {
    /// Takes a token; returns whether it was a name, and the colon after it is to be skipped.
    fn token(&mut self, token: &Token, named: bool, opens: bool) -> bool {
        let level = self.frames.len() - 1;
        let mut skip = false;
        match token.kind {
            Kind::Word | Kind::Open(_) => {
                let bracketed = self.frames[level].bracket != b'[' && level > 0;
                if named && bracketed && self.frames[level].value.is_none() {
                    self.frames[level].key = Some(self.text[token.span.clone()].trim_matches('"'));
                    skip = true;
                } else {
                    self.value(token, opens);
                }
            }
            Kind::Close => {
                self.end_value();
                if level > 0 {
                    self.frames.pop();
                }
            }
            Kind::Comma => {
                self.end_value();
                self.frames[level].index += 1;
            }
            Kind::Colon => {}
        }
        self.last = token.span.end;
        skip
    }

    fn value(&mut self, token: &Token, opens: bool) {
        let level = self.frames.len() - 1;
        let deep = level > self.depth;
        let frame = &mut self.frames[level];
        if frame.value.is_none() {
            let key = match frame.key.take() {
                Some(name) => Some(Key::Name(name)),
                // Plain elements of a list belong to the list.
                None => (frame.bracket == b'[' && opens).then_some(Key::Index(frame.index)),
            };
            frame.value = match key {
                Some(key) if !deep => {
                    let span = token.span.clone();
                    self.entries.push(Entry { parent: frame.owner, key, span, words: 0, groups: 0 });
                    Some((Some(self.entries.len() - 1), true))
                }
                _ => Some((frame.owner, false)),
            };
        }
        let (entry, own) = frame.value.unwrap_or_default();
        if let (Some(i), true) = (entry, own) {
            match token.kind {
                Kind::Word => self.entries[i].words += 1,
                _ => self.entries[i].groups += 1,
            }
        }
        if let Kind::Open(bracket) = token.kind {
            self.frames.push(Frame::new(bracket, entry));
        }
    }

    fn end_value(&mut self) {
        let Some(frame) = self.frames.last_mut() else { return };
        frame.key = None;
        if let Some((Some(i), true)) = frame.value.take() {
            self.entries[i].span.end = self.last;
        }
    }

    fn finish(mut self) -> Vec<Entry<'a>> {
        while !self.frames.is_empty() {
            self.end_value();
            self.frames.pop();
        }
        self.entries
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Open(u8),
    Close,
    Comma,
    Colon,
    /// A name, number, string or anything else.
    Word,
}

#[derive(Debug, Clone)]
struct Token {
    kind: Kind,
    span: Range<usize>,
}

/// Tokens of a RON text; comments and white space are skipped, and nothing is an error.
struct Tokens<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Whether the last comment has no end.
    unclosed: bool,
}

impl<'a> Tokens<'a> {
    fn new(text: &'a str) -> Self {
        Self { bytes: text.as_bytes(), position: 0, unclosed: false }
    }

    fn byte(&self, ahead: usize) -> Option<u8> {
        self.bytes.get(self.position + ahead).copied()
    }

    fn skip_comment(&mut self) -> bool {
        match (self.byte(0), self.byte(1)) {
            (Some(b'/'), Some(b'/')) => {
                while self.byte(0).is_some_and(|b| b != b'\n') {
                    self.position += 1;
                }
                true
            }
            (Some(b'/'), Some(b'*')) => {
                let mut depth = 0u32;
                while let Some(byte) = self.byte(0) {
                    match (byte, self.byte(1)) {
                        (b'/', Some(b'*')) => depth += 1,
                        (b'*', Some(b'/')) => depth -= 1,
                        _ => {
                            self.position += 1;
                            continue;
                        }
                    }
                    self.position += 2;
                    if depth == 0 {
                        break;
                    }
                }
                self.unclosed = depth > 0;
                true
            }
            _ => false,
        }
    }

    fn skip_string(&mut self) {
        self.position += 1;
        while let Some(byte) = self.byte(0) {
            self.position += if byte == b'\\' { 2 } else { 1 };
            if byte == b'"' {
                break;
            }
        }
        self.position = self.position.min(self.bytes.len());
    }

    /// Skips `r"…"`, `r#"…"#` and so on, if that is what begins here.
    fn skip_raw_string(&mut self) -> bool {
        if self.byte(0) != Some(b'r') {
            return false;
        }
        let hashes = self.bytes[self.position + 1..].iter().take_while(|b| **b == b'#').count();
        if self.byte(1 + hashes) != Some(b'"') {
            return false;
        }
        self.position += 2 + hashes;
        while let Some(byte) = self.byte(0) {
            self.position += 1;
            if byte == b'"' && (0..hashes).all(|i| self.byte(i) == Some(b'#')) {
                self.position += hashes;
                break;
            }
        }
        true
    }

    /// Skips `'x'` or an escaped one, or the quote alone.
    fn skip_char(&mut self) {
        let from = if self.byte(1) == Some(b'\\') { 3 } else { 2 };
        let close = (from..from + 10).find(|i| self.byte(*i) == Some(b'\''));
        self.position = (self.position + close.map_or(1, |i| i + 1)).min(self.bytes.len());
    }
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        while self.byte(0).is_some_and(|b| b.is_ascii_whitespace()) || self.skip_comment() {
            if self.byte(0).is_some_and(|b| b.is_ascii_whitespace()) {
                self.position += 1;
            }
        }
        let start = self.position;
        let kind = match self.byte(0)? {
            b @ (b'(' | b'[' | b'{') => Kind::Open(b),
            b')' | b']' | b'}' => Kind::Close,
            b',' => Kind::Comma,
            b':' => Kind::Colon,
            _ => Kind::Word,
        };
        if kind != Kind::Word {
            self.position += 1;
        } else if self.byte(0) == Some(b'"') {
            self.skip_string();
        } else if self.byte(0) == Some(b'\'') {
            self.skip_char();
        } else if !self.skip_raw_string() {
            self.position += 1;
            while self.byte(0).is_some_and(|b| !b.is_ascii_whitespace() && !b"()[]{},:\"'/".contains(&b)) {
                self.position += 1;
            }
        }
        Some(Token { kind, span: start..self.position })
    }
}
