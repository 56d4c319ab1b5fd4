//! The machine: opcode by opcode over the bytes.

use std::ops::Range;

use super::arrays;
use super::error::PickleError;
use super::node::{Global, Heap, Id, Node};

/// Most bytes of a pickle.
const MAX_BYTES: usize = 32 << 20;
/// Most values: each takes a byte of the pickle at least, most of them ten.
const MAX_NODES: usize = 4 << 20;
/// Most marks within one another.
const MAX_MARKS: usize = 64;
/// Nodes that are there from the beginning.
const NONE: Id = 0;
const FALSE: Id = 1;
const TRUE: Id = 2;

/// Runs a pickle: its nodes, and which of them is the answer.
pub(super) fn run(bytes: &[u8]) -> Result<(Vec<Node>, Id), PickleError> {
    if bytes.len() > MAX_BYTES {
        let problem = format!("{} bytes, at most {MAX_BYTES} are possible", bytes.len());
        return Err(PickleError { offset: 0, problem });
    }
    let nodes = vec![Node::None, Node::Bool(false), Node::Bool(true)];
    let mut machine = Machine {
        heap: Heap { bytes, nodes },
        at: 0,
        op: 0,
        stack: Vec::new(),
        marks: Vec::new(),
        memo: Vec::new(),
    };
    loop {
        if let Some(answer) = machine.step()? {
            return Ok((machine.heap.nodes, answer));
        }
    }
}

struct Machine<'a> {
    heap: Heap<'a>,
    at: usize,
    /// Where the opcode in hand stands.
    op: usize,
    stack: Vec<Id>,
    /// Heights of the stack at which marks stand.
    marks: Vec<usize>,
    memo: Vec<Option<Id>>,
}

impl Machine<'_> {
    fn fault(&self, problem: impl Into<String>) -> PickleError {
        PickleError { offset: self.op, problem: problem.into() }
    }

    fn take(&mut self, count: usize) -> Result<Range<usize>, PickleError> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.heap.bytes.len());
        let end = end.ok_or_else(|| self.fault("it ends early"))?;
        let range = self.at..end;
        self.at = end;
        Ok(range)
    }

    fn fixed<const N: usize>(&mut self) -> Result<[u8; N], PickleError> {
        let range = self.take(N)?;
        Ok(std::array::from_fn(|i| self.heap.bytes[range.start + i]))
    }

    /// A length of 1, 4 or 8 bytes, and so many bytes.
    fn counted<const N: usize>(&mut self) -> Result<Range<usize>, PickleError> {
        let mut wide = [0; 8];
        wide[..N].copy_from_slice(&self.fixed::<N>()?);
        let count = usize::try_from(u64::from_le_bytes(wide)).unwrap_or(usize::MAX);
        self.take(count)
    }

    fn line(&mut self) -> Result<Range<usize>, PickleError> {
        let rest = &self.heap.bytes[self.at..];
        let length = rest.iter().position(|&b| b == b'\n').ok_or_else(|| self.fault("a name without end"))?;
        let range = self.take(length)?;
        self.at += 1;
        Ok(range)
    }

    fn push(&mut self, node: Node) -> Result<(), PickleError> {
        if self.heap.nodes.len() >= MAX_NODES {
            return Err(self.fault(format!("more than {MAX_NODES} values")));
        }
        self.stack.push(self.heap.nodes.len() as Id);
        self.heap.nodes.push(node);
        Ok(())
    }

    fn push_text(&mut self, range: Range<usize>) -> Result<(), PickleError> {
        if std::str::from_utf8(&self.heap.bytes[range.clone()]).is_err() {
            return Err(self.fault("a text that is not UTF-8"));
        }
        self.push(Node::Text(range))
    }

    fn pop(&mut self) -> Result<Id, PickleError> {
        let floor = self.marks.last().copied().unwrap_or(0);
        if self.stack.len() <= floor {
            return Err(self.fault("nothing is there to be taken"));
        }
        self.stack.pop().ok_or_else(|| self.fault("nothing is there to be taken"))
    }

    fn top(&mut self) -> Result<Id, PickleError> {
        let id = self.pop()?;
        self.stack.push(id);
        Ok(id)
    }

    /// The values above the last mark, which is removed.
    fn above_mark(&mut self) -> Result<Vec<Id>, PickleError> {
        let floor = self.marks.pop().ok_or_else(|| self.fault("there is no mark"))?;
        Ok(self.stack.split_off(floor))
    }

    fn remember(&mut self, place: usize) -> Result<(), PickleError> {
        // Python counts from 0 without gaps.
        if place > self.memo.len() {
            return Err(self.fault(format!("puts {place} into a memo of {}", self.memo.len())));
        }
        let id = self.top()?;
        match self.memo.get_mut(place) {
            Some(known) => *known = Some(id),
            None => self.memo.push(Some(id)),
        }
        Ok(())
    }

    fn recall(&mut self, place: usize) -> Result<(), PickleError> {
        let id = self.memo.get(place).copied().flatten();
        let id = id.ok_or_else(|| self.fault(format!("the memo has no {place}")))?;
        self.stack.push(id);
        Ok(())
    }

    /// One opcode; the answer at the last.
    fn step(&mut self) -> Result<Option<Id>, PickleError> {
        self.op = self.at;
        let [op] = self.fixed::<1>()?;
        match op {
            b'.' => return self.stop().map(Some),
            b'\x80' => self.protocol()?,
            b'\x95' => self.frame()?,
            b'N' => self.stack.push(NONE),
            b'\x88' => self.stack.push(TRUE),
            b'\x89' => self.stack.push(FALSE),
            b'K' | b'M' | b'J' | b'\x8a' | b'G' => self.number(op)?,
            b'X' => self.counted::<4>().and_then(|range| self.push_text(range))?,
            b'\x8c' => self.counted::<1>().and_then(|range| self.push_text(range))?,
            b'B' => self.counted::<4>().and_then(|range| self.push(Node::Bytes(range)))?,
            b'C' => self.counted::<1>().and_then(|range| self.push(Node::Bytes(range)))?,
            b'c' => self.global()?,
            b'\x93' => self.stack_global()?,
            b'(' => self.mark()?,
            b']' => self.push(Node::List(Vec::new()))?,
            b'}' => self.push(Node::Dict(Vec::new()))?,
            b')' => self.push(Node::Tuple(Vec::new()))?,
            b'\x85' => self.tuple(1)?,
            b'\x86' => self.tuple(2)?,
            b'\x87' => self.tuple(3)?,
            b't' => self.above_mark().and_then(|items| self.push(Node::Tuple(items)))?,
            b'a' => self.pop().and_then(|item| self.append(vec![item]))?,
            b'e' => self.above_mark().and_then(|items| self.append(items))?,
            b's' => {
                let (value, key) = (self.pop()?, self.pop()?);
                self.set(&[key, value])?;
            }
            b'u' => self.above_mark().and_then(|items| self.set(&items))?,
            b'\x94' => self.remember(self.memo.len())?,
            b'q' => self.fixed().and_then(|[place]: [u8; 1]| self.remember(usize::from(place)))?,
            b'r' => self.fixed().and_then(|place| self.remember(u32::from_le_bytes(place) as usize))?,
            b'h' => self.fixed().and_then(|[place]: [u8; 1]| self.recall(usize::from(place)))?,
            b'j' => self.fixed().and_then(|place| self.recall(u32::from_le_bytes(place) as usize))?,
            b'R' => {
                let (arguments, what) = (self.pop()?, self.pop()?);
                let made = arrays::reduce(&self.heap, what, arguments).map_err(|e| self.fault(e))?;
                self.push(made)?;
            }
            b'b' => {
                let (state, what) = (self.pop()?, self.top()?);
                let built = arrays::build(&self.heap, what, state).map_err(|e| self.fault(e))?;
                self.heap.nodes[what as usize] = built;
            }
            other => return Err(self.fault(format!("opcode {other:#04x} is not known here"))),
        }
        Ok(None)
    }

    fn stop(&mut self) -> Result<Id, PickleError> {
        let answer = self.pop()?;
        if !self.stack.is_empty() || !self.marks.is_empty() {
            return Err(self.fault("it stops with values left"));
        }
        if self.at != self.heap.bytes.len() {
            return Err(self.fault("something behind the end"));
        }
        Ok(answer)
    }

    fn protocol(&mut self) -> Result<(), PickleError> {
        let [version] = self.fixed::<1>()?;
        if (2..=5).contains(&version) { Ok(()) } else { Err(self.fault(format!("protocol {version}"))) }
    }

    /// A frame only says how much to read at once.
    fn frame(&mut self) -> Result<(), PickleError> {
        let length = u64::from_le_bytes(self.fixed()?);
        let left = (self.heap.bytes.len() - self.at) as u64;
        if length <= left {
            Ok(())
        } else {
            Err(self.fault(format!("a frame of {length} bytes, {left} are left")))
        }
    }

    fn number(&mut self, op: u8) -> Result<(), PickleError> {
        let node = match op {
            b'K' => Node::Int(i128::from(self.fixed::<1>()?[0])),
            b'M' => Node::Int(i128::from(u16::from_le_bytes(self.fixed()?))),
            b'J' => Node::Int(i128::from(i32::from_le_bytes(self.fixed()?))),
            b'G' => Node::Float(f64::from_be_bytes(self.fixed()?)),
            _ => {
                let range = self.counted::<1>()?;
                if range.len() > 16 {
                    return Err(self.fault("a whole number of more than 16 bytes"));
                }
                let digits = &self.heap.bytes[range];
                // Two's complement, lowest byte first.
                let fill = if digits.last().is_some_and(|&b| b >= 0x80) { 0xff } else { 0 };
                let mut wide = [fill; 16];
                wide[..digits.len()].copy_from_slice(digits);
                Node::Int(i128::from_le_bytes(wide))
            }
        };
        self.push(node)
    }

    fn global(&mut self) -> Result<(), PickleError> {
        let (module, name) = (self.line()?, self.line()?);
        self.named(module, name)
    }

    fn stack_global(&mut self) -> Result<(), PickleError> {
        let (name, module) = (self.pop()?, self.pop()?);
        match (self.heap.node(module), self.heap.node(name)) {
            (Node::Text(module), Node::Text(name)) => self.named(module.clone(), name.clone()),
            _ => Err(self.fault("a name that is no text")),
        }
    }

    fn named(&mut self, module: Range<usize>, name: Range<usize>) -> Result<(), PickleError> {
        match Global::find(self.heap.text(&module), self.heap.text(&name)) {
            Some(global) => self.push(Node::Global(global)),
            None => {
                let shown = |range: &Range<usize>| {
                    let text = String::from_utf8_lossy(self.heap.raw(range));
                    text.chars().take(60).collect::<String>().escape_debug().to_string()
                };
                let (module, name) = (shown(&module), shown(&name));
                Err(self.fault(format!("wants `{module}.{name}`, which is not known here and never called")))
            }
        }
    }

    fn mark(&mut self) -> Result<(), PickleError> {
        if self.marks.len() >= MAX_MARKS {
            return Err(self.fault(format!("more than {MAX_MARKS} marks within one another")));
        }
        self.marks.push(self.stack.len());
        Ok(())
    }

    fn tuple(&mut self, count: usize) -> Result<(), PickleError> {
        let mut items = Vec::with_capacity(count);
        for _ in 0..count {
            items.push(self.pop()?);
        }
        items.reverse();
        self.push(Node::Tuple(items))
    }

    fn append(&mut self, items: Vec<Id>) -> Result<(), PickleError> {
        let list = self.top()?;
        let Node::List(known) = &mut self.heap.nodes[list as usize] else {
            return Err(self.fault("appends to what is no list"));
        };
        known.extend(items);
        Ok(())
    }

    fn set(&mut self, items: &[Id]) -> Result<(), PickleError> {
        if !items.len().is_multiple_of(2) {
            return Err(self.fault("a key without a value"));
        }
        if items.iter().step_by(2).any(|&key| !matches!(self.heap.node(key), Node::Text(_))) {
            return Err(self.fault("a key that is no text"));
        }
        let dict = self.top()?;
        let Node::Dict(known) = &mut self.heap.nodes[dict as usize] else {
            return Err(self.fault("sets a key of what is no dictionary"));
        };
        known.extend(items.chunks_exact(2).map(|pair| (pair[0], pair[1])));
        Ok(())
    }
}
