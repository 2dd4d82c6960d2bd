//! Reads the tree: from `HIERARCHY` to before `MOTION`.
//!
//! Words, not lines, carry the grammar, so braces may stand anywhere; only a joint's name is the rest of its line.
//! The blocks that are open are kept on a stack of our own, so depth costs memory that the file itself has paid for.

use std::collections::HashMap;

use super::{
    BvhJoint, Channel,
    cursor::Cursor,
    error::{Expected, Failure, WarningKind},
    number::number,
};

/// The tree as declared.
pub(super) struct Hierarchy {
    pub(super) joints: Vec<BvhJoint>,
    pub(super) n_channels: usize,
    /// Whether `MOTION` follows; the cursor stands after it, or at the end of the text.
    pub(super) has_motion: bool,
}

/// A block whose closing brace is still to come.
enum Block {
    Joint(OpenJoint),
    EndSite { joint_idx: usize, name_at: usize, offset: Option<[f64; 3]>, is_first: bool },
}

/// What has been read of a joint so far.
struct OpenJoint {
    idx: usize,
    name_at: usize,
    has_offset: bool,
    has_channels: bool,
    has_children: bool,
}

/// The tree while it grows.
struct Reader<'a, 'w> {
    cursor: &'w mut Cursor<'a>,
    warnings: &'w mut Vec<(usize, WarningKind)>,
    joints: Vec<BvhJoint>,
    n_channels: usize,
    open: Vec<Block>,
    /// How often each name has been met.
    n_named: HashMap<String, usize>,
}

/// Reads the tree and leaves the cursor after `MOTION`.
pub(super) fn hierarchy(
    cursor: &mut Cursor<'_>,
    warnings: &mut Vec<(usize, WarningKind)>,
) -> Result<Hierarchy, Failure> {
    let mut reader =
        Reader { cursor, warnings, joints: Vec::new(), n_channels: 0, open: Vec::new(), n_named: HashMap::new() };
    reader.opening()?;
    let has_motion = reader.blocks()?;
    Ok(Hierarchy { joints: reader.joints, n_channels: reader.n_channels, has_motion })
}

impl Reader<'_, '_> {
    /// `HIERARCHY`, and that a root follows.
    fn opening(&mut self) -> Result<(), Failure> {
        let has_keyword = self.cursor.take("HIERARCHY");
        if !self.cursor.peek().eq_ignore_ascii_case(b"ROOT") {
            let keyword = if has_keyword { "ROOT" } else { "HIERARCHY" };
            return Err(self.unexpected(Expected::Keyword(keyword)));
        }
        if !has_keyword {
            self.warn(WarningKind::NoHierarchy);
        }
        Ok(())
    }

    /// All trees; tells whether `MOTION` ended them.
    fn blocks(&mut self) -> Result<bool, Failure> {
        loop {
            match self.open.pop() {
                None => {
                    if self.cursor.take("ROOT") {
                        self.joint(None)?;
                    } else if self.cursor.take("MOTION") {
                        return Ok(true);
                    } else if self.cursor.is_at_end() {
                        return Ok(false);
                    } else {
                        return Err(self.unexpected(Expected::RootOrMotion));
                    }
                }
                Some(Block::Joint(joint)) => self.joint_part(joint)?,
                Some(Block::EndSite { joint_idx, name_at, offset, is_first }) => {
                    self.end_site_part(joint_idx, name_at, offset, is_first)?;
                }
            }
        }
    }

    /// Name and opening brace of a joint.
    fn joint(&mut self, parent: Option<usize>) -> Result<(), Failure> {
        self.cursor.skip_space();
        let name_at = self.cursor.at;
        let name = self.name(name_at);
        self.opening_brace()?;
        if parent.is_none() && !self.joints.is_empty() {
            self.warnings.push((name_at, WarningKind::AnotherRoot { name: name.clone() }));
        }
        let n_named = self.n_named.entry(name.clone()).or_default();
        *n_named += 1;
        if *n_named == 2 {
            self.warnings.push((name_at, WarningKind::SameName { name: name.clone() }));
        }
        let idx = self.joints.len();
        let first_channel = self.n_channels;
        self.joints.push(BvhJoint {
            name,
            parent,
            offset: [0.0; 3],
            channels: Vec::new(),
            first_channel,
            end_site: None,
        });
        let joint = OpenJoint { idx, name_at, has_offset: false, has_channels: false, has_children: false };
        self.open.push(Block::Joint(joint));
        Ok(())
    }

    /// One line of a joint's block, or its closing brace.
    fn joint_part(&mut self, mut joint: OpenJoint) -> Result<(), Failure> {
        if self.cursor.take("JOINT") {
            joint.has_children = true;
            let idx = joint.idx;
            self.open.push(Block::Joint(joint));
            return self.joint(Some(idx));
        }
        if self.cursor.take("End") || self.cursor.take("EndSite") {
            let joint_idx = joint.idx;
            self.open.push(Block::Joint(joint));
            return self.end_site(joint_idx);
        }
        if self.cursor.take("}") {
            self.close_joint(&joint);
            return Ok(());
        }
        if !joint.has_offset && self.cursor.take("OFFSET") {
            self.joints[joint.idx].offset = self.offset()?;
            joint.has_offset = true;
        } else if !joint.has_channels && !joint.has_children && self.cursor.take("CHANNELS") {
            self.channels(joint.idx, joint.has_offset)?;
            joint.has_channels = true;
        } else if self.cursor.is_at_end() || self.cursor.peek().eq_ignore_ascii_case(b"MOTION") {
            return Err(self.unexpected(Expected::Keyword("}")));
        } else {
            let (offset, channels) = (!joint.has_offset, !joint.has_channels && !joint.has_children);
            return Err(self.unexpected(Expected::JointPart { offset, channels }));
        }
        self.open.push(Block::Joint(joint));
        Ok(())
    }

    fn close_joint(&mut self, joint: &OpenJoint) {
        let declared = &mut self.joints[joint.idx];
        if !joint.has_offset {
            self.warnings.push((joint.name_at, WarningKind::NoOffset { name: declared.name.clone() }));
        }
        if !joint.has_channels {
            self.warnings.push((joint.name_at, WarningKind::NoChannels { name: declared.name.clone() }));
        }
    }

    /// The rest of `End Site`, with or without a name, and the opening brace.
    fn end_site(&mut self, joint_idx: usize) -> Result<(), Failure> {
        let name_at = self.cursor.at;
        self.cursor.take_name();
        self.opening_brace()?;
        let is_first = self.joints[joint_idx].end_site.is_none();
        if !is_first {
            let name = self.joints[joint_idx].name.clone();
            self.warnings.push((name_at, WarningKind::AnotherEndSite { name }));
        }
        self.open.push(Block::EndSite { joint_idx, name_at, offset: None, is_first });
        Ok(())
    }

    /// One line of an end site's block, or its closing brace.
    fn end_site_part(
        &mut self,
        joint_idx: usize,
        name_at: usize,
        offset: Option<[f64; 3]>,
        is_first: bool,
    ) -> Result<(), Failure> {
        if self.cursor.take("}") {
            let joint = &mut self.joints[joint_idx];
            if offset.is_none() {
                self.warnings.push((name_at, WarningKind::NoOffset { name: joint.name.clone() }));
            }
            if is_first {
                joint.end_site = Some(offset.unwrap_or_default());
            }
            return Ok(());
        }
        if offset.is_some() || !self.cursor.take("OFFSET") {
            return Err(self.unexpected(Expected::EndSitePart));
        }
        let offset = Some(self.offset()?);
        self.open.push(Block::EndSite { joint_idx, name_at, offset, is_first });
        Ok(())
    }

    fn offset(&mut self) -> Result<[f64; 3], Failure> {
        let mut offset = [0.0; 3];
        for value in &mut offset {
            *value = header_number(self.cursor)?;
        }
        Ok(offset)
    }

    /// A count and channel names; where the two disagree the names count.
    fn channels(&mut self, joint_idx: usize, has_offset: bool) -> Result<(), Failure> {
        self.cursor.skip_space();
        let at = self.cursor.at;
        let written = std::str::from_utf8(self.cursor.peek())
            .ok()
            .and_then(|word| word.parse::<u64>().ok())
            .ok_or_else(|| Failure::at_word(self.cursor, Expected::Count))?;
        self.cursor.at = self.cursor.word_span().end;

        let mut channels = Vec::new();
        while let Some(channel) = Channel::from_name(self.cursor.peek()) {
            self.cursor.at = self.cursor.word_span().end;
            channels.push(channel);
        }
        let next = self.cursor.peek();
        let is_keyword = [&b"JOINT"[..], b"End", b"EndSite", b"OFFSET", b"CHANNELS", b"MOTION", b"ROOT", b"{", b"}"]
            .iter()
            .any(|k| next.eq_ignore_ascii_case(k));
        if !is_keyword {
            let is_short = (channels.len() as u64) < written;
            let after = Expected::JointPart { offset: !has_offset, channels: false };
            return Err(self.unexpected(if is_short { Expected::ChannelName } else { after }));
        }
        let joint = &mut self.joints[joint_idx];
        if channels.len() as u64 != written {
            let kind = WarningKind::ChannelCount { name: joint.name.clone(), written, named: channels.len() };
            self.warnings.push((at, kind));
        }
        joint.first_channel = self.n_channels;
        self.n_channels += channels.len();
        joint.channels = channels;
        Ok(())
    }

    fn name(&mut self, at: usize) -> String {
        let bytes = self.cursor.take_name();
        if bytes.is_empty() {
            self.warnings.push((at, WarningKind::NoName));
        }
        match std::str::from_utf8(bytes) {
            Ok(name) => name.to_owned(),
            Err(_) => {
                let name: String = bytes.iter().map(|&b| char::from(b)).collect();
                self.warnings.push((at, WarningKind::NameNotUtf8 { name: name.clone() }));
                name
            }
        }
    }

    fn opening_brace(&mut self) -> Result<(), Failure> {
        if self.cursor.take("{") { Ok(()) } else { Err(self.unexpected(Expected::Keyword("{"))) }
    }

    fn warn(&mut self, kind: WarningKind) {
        self.warnings.push((self.cursor.at, kind));
    }

    fn unexpected(&mut self, expected: Expected) -> Failure {
        self.cursor.skip_space();
        Failure::at_word(self.cursor, expected)
    }
}

/// Reads a finite number that a brace may end.
pub(super) fn header_number(cursor: &mut Cursor<'_>) -> Result<f64, Failure> {
    cursor.skip_space();
    let span = cursor.word_span();
    let (value, end) = number(&cursor.text[..span.end], span.start).ok_or_else(|| Failure::at_number(cursor))?;
    cursor.at = end;
    Ok(value)
}
