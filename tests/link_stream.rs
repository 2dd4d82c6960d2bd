//! The link end to end over byte streams: what is sent arrives, and nothing else that arrives does harm.

mod link_sample;

use std::{
    io::{self, Read},
    sync::Arc,
};

use glam::DVec3;
use link_sample::{now, scene, still};
use walkabout::{
    key::{Code, Key},
    link::{Error, EventReader, EventWriter, Fault, SceneReader, SceneWriter, VERSION, check_scene},
    scene::{FromPreview, Picture, Ray, Scene, ToPreview},
};

/// Bytes before the first message.
const HELLO_LEN: usize = 11;

fn scene_bytes(messages: &[ToPreview]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = SceneWriter::new(&mut bytes).expect("memory takes everything");
    for message in messages {
        writer.send(message).expect("a good message is sent");
    }
    bytes
}

fn event_bytes(events: &[FromPreview]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = EventWriter::new(&mut bytes).expect("memory takes everything");
    for event in events {
        writer.send(event).expect("a good event is sent");
    }
    bytes
}

/// Reads a stream to its end: what came, and how it ended.
fn read_scenes(stream: impl Read) -> (Vec<ToPreview>, Result<(), Error>) {
    let mut reader = SceneReader::new(stream);
    collect(|| reader.read())
}

fn read_events(stream: impl Read) -> (Vec<FromPreview>, Result<(), Error>) {
    let mut reader = EventReader::new(stream);
    collect(|| reader.read())
}

fn collect<T>(mut read: impl FnMut() -> Result<Option<T>, Error>) -> (Vec<T>, Result<(), Error>) {
    let mut all = Vec::new();
    loop {
        match read() {
            Ok(Some(message)) => all.push(message),
            Ok(None) => return (all, Ok(())),
            Err(e) => return (all, Err(e)),
        }
    }
}

fn messages() -> Vec<ToPreview> {
    let mut playing = scene(7, 0);
    let mut messages = vec![ToPreview::Size { width: 120, height: 80 }];
    for frame in 0..3 {
        playing.now = now(frame);
        messages.push(ToPreview::Scene(playing.clone()));
    }
    messages.push(ToPreview::Scene(scene(8, 3)));
    messages.push(ToPreview::Close);
    messages
}

fn events() -> Vec<FromPreview> {
    let ray = Ray { view: 1, origin: DVec3::new(1.0, 2.0, 3.0), direction: DVec3::NEG_Y };
    let rgb = (0..=255).cycle().take(16 * 9 * 3).collect();
    vec![
        FromPreview::Ready { device: "llvmpipe".to_owned(), driver: "Mesa 22.3.6".to_owned() },
        FromPreview::Key(Key { code: Code::Left, ctrl: true, alt: false, shift: true }),
        FromPreview::Pick(ray),
        FromPreview::Drag(ray),
        FromPreview::Wheel { view: 3, steps: -2 },
        FromPreview::Release,
        FromPreview::Frame(Picture { width: 16, height: 9, rgb }),
        FromPreview::Failed("no driver".to_owned()),
        FromPreview::Closed,
    ]
}

/// Hands out one byte at a time, with an interruption before each.
struct Drip<'a> {
    bytes: &'a [u8],
    interrupted: bool,
}

impl Read for Drip<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.interrupted = !self.interrupted;
        if self.interrupted {
            return Err(io::ErrorKind::Interrupted.into());
        }
        let len = buffer.len().min(self.bytes.len()).min(1);
        let (first, rest) = self.bytes.split_at(len);
        buffer[..len].copy_from_slice(first);
        self.bytes = rest;
        Ok(len)
    }
}

#[test]
fn what_is_sent_arrives_also_one_byte_at_a_time() {
    let bytes = scene_bytes(&messages());
    let drip = Drip { bytes: &bytes, interrupted: false };
    for (got, end) in [read_scenes(&bytes[..]), read_scenes(drip)] {
        assert_eq!(got, messages());
        assert!(end.is_ok(), "{end:?}");
    }
    let bytes = event_bytes(&events());
    let drip = Drip { bytes: &bytes, interrupted: false };
    for (got, end) in [read_events(&bytes[..]), read_events(drip)] {
        assert_eq!(got, events());
        assert!(end.is_ok(), "{end:?}");
    }
}

#[test]
fn playing_costs_a_few_kilobytes_a_frame() {
    let first = scene_bytes(&[ToPreview::Scene(scene(7, 0))]).len();
    let both = scene_bytes(&[ToPreview::Scene(scene(7, 0)), ToPreview::Scene(scene(7, 1))]).len();
    let frame = both - first;
    // Two actors of 31 joints are 1488 bytes of points.
    assert!((1488..2560).contains(&frame), "{frame} bytes a frame");
    assert!(first > 4 * frame, "the still part went along with the first scene: {first} bytes");
}

#[test]
fn the_still_part_travels_once_a_revision_and_is_shared() {
    let (got, _) = read_scenes(&scene_bytes(&messages())[..]);
    let stills: Vec<_> = got
        .iter()
        .filter_map(|m| if let ToPreview::Scene(Scene { still, .. }) = m { Some(still) } else { None })
        .collect();
    assert!(Arc::ptr_eq(stills[0], stills[1]) && Arc::ptr_eq(stills[1], stills[2]));
    assert_eq!(stills[3].revision, 8);
}

#[test]
fn a_stream_cut_anywhere_gives_the_whole_messages_before_the_cut() {
    let all = messages();
    let ends: Vec<usize> = (0..=all.len()).map(|n| scene_bytes(&all[..n]).len()).collect();
    // The still part is a message of its own, so a cut just after one is clean but completes nothing.
    let still_len = |message: &ToPreview| match message {
        ToPreview::Scene(s) => postcard::to_stdvec(s.still.as_ref()).expect("encodes").len() + 5,
        _ => unreachable!("only scenes have a still part"),
    };
    let clean = [&ends[..], &[0, ends[1] + still_len(&all[1]), ends[4] + still_len(&all[4])]].concat();
    let bytes = scene_bytes(&all);
    for cut in 0..bytes.len() {
        let (got, end) = read_scenes(&bytes[..cut]);
        let whole = ends.iter().filter(|&&end| end <= cut).count().saturating_sub(1);
        assert_eq!(got.len(), whole, "cut at {cut}");
        assert_eq!(got, all[..whole], "cut at {cut}");
        match end {
            Ok(()) => assert!(clean.contains(&cut), "cut at {cut} went unnoticed"),
            Err(Error::Truncated { expected, found }) => {
                assert!(found < expected && !clean.contains(&cut), "cut at {cut}")
            }
            Err(e) => panic!("cut at {cut}: {e}"),
        }
    }
    let bytes = event_bytes(&events());
    for cut in HELLO_LEN..bytes.len() {
        let (got, end) = read_events(&bytes[..cut]);
        assert_eq!(got, events()[..got.len()], "cut at {cut}");
        assert!(matches!(end, Ok(()) | Err(Error::Truncated { .. })), "cut at {cut}: {end:?}");
    }
}

#[test]
fn foreign_bytes_and_other_versions_are_named() {
    let end = |bytes: &[u8]| read_scenes(bytes).1;
    assert!(matches!(end(b"HTTP/1.1 400 Bad Request\r\n"), Err(Error::Foreign)));
    assert!(matches!(end(b"\x7fELF"), Err(Error::Foreign)));
    assert!(matches!(end(&[0; 64]), Err(Error::Foreign)));
    assert!(matches!(end(b"walk"), Err(Error::Truncated { expected: HELLO_LEN, found: 4 })));
    let mut bytes = scene_bytes(&messages());
    bytes[9] = 99;
    let error = end(&bytes).expect_err("another version");
    assert_eq!(error.to_string(), format!("the link speaks version 99, this program version {VERSION}"));
}

#[test]
fn each_end_refuses_its_own_kind_of_messages() {
    let bytes = scene_bytes(&messages());
    assert!(matches!(read_events(&bytes[..]).1, Err(Error::UnknownKind(_))));
    let bytes = event_bytes(&events());
    assert!(matches!(read_scenes(&bytes[..]).1, Err(Error::UnknownKind(_))));
}

#[test]
fn a_moving_part_before_any_still_part_is_refused() {
    let with = scene_bytes(&[ToPreview::Scene(scene(7, 0))]);
    let length = u32::from_le_bytes(with[HELLO_LEN..HELLO_LEN + 4].try_into().expect("four bytes")) as usize;
    let without = [&with[..HELLO_LEN], &with[HELLO_LEN + 5 + length..]].concat();
    assert!(matches!(read_scenes(&without[..]).1, Err(Error::NowBeforeStill)));
}

#[test]
fn a_payload_with_bytes_too_many_or_too_few_is_refused() {
    let good = scene_bytes(&[ToPreview::Size { width: 9, height: 9 }]);
    let mut long = good.clone();
    long[HELLO_LEN] += 1;
    long.push(0);
    assert!(matches!(read_scenes(&long[..]).1, Err(Error::Trailing { extra: 1, .. })));
    let mut short = good;
    short[HELLO_LEN] -= 1;
    short.pop();
    assert!(matches!(read_scenes(&short[..]).1, Err(Error::Malformed(_))));
}

#[test]
fn scenes_and_events_that_cannot_be_shown_are_refused_on_arrival() {
    let mut bad = scene(7, 0);
    bad.now.actors[1].pop();
    assert_eq!(check_scene(&bad), Err(Fault::Limb { body: 1, point: 30, points: 30 }));
    let bytes = scene_bytes(&[ToPreview::Scene(bad)]);
    assert!(matches!(read_scenes(&bytes[..]).1, Err(Error::Fault(Fault::Limb { .. }))));
    let bytes = scene_bytes(&[ToPreview::Size { width: 100_000, height: 100_000 }]);
    assert!(matches!(read_scenes(&bytes[..]).1, Err(Error::Fault(Fault::Size { .. }))));
    let bytes = event_bytes(&[FromPreview::Frame(Picture { width: 4, height: 4, rgb: vec![0; 47] })]);
    assert!(matches!(read_events(&bytes[..]).1, Err(Error::Fault(Fault::Pixels { bytes: 47, .. }))));
    let bytes = event_bytes(&[FromPreview::Key(Key::plain(Code::F(200)))]);
    assert!(matches!(read_events(&bytes[..]).1, Err(Error::Fault(Fault::Key))));
}

#[test]
fn texts_from_a_preview_are_one_harmless_line() {
    let bytes = event_bytes(&[FromPreview::Failed("no\n\u{1b}]0;title\u{7}driver".to_owned())]);
    assert_eq!(read_events(&bytes[..]).0, [FromPreview::Failed("no ]0;title driver".to_owned())]);
}

/// A small generator of pseudo-random numbers (splitmix64), so that a failure can be repeated.
struct Seeded(u64);

impl Seeded {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end as u64) as usize
    }

    /// Changes, inserts and removes a few bytes.
    fn spoil(&mut self, bytes: &mut Vec<u8>) {
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            match self.below(8) {
                0 => bytes.insert(at, self.below(256) as u8),
                1 => drop(bytes.remove(at)),
                2 => bytes[at] = [0, 1, 127, 128, 255][self.below(5)],
                _ => bytes[at] ^= 1 << self.below(8),
            }
        }
    }
}

#[test]
fn what_survives_random_damage_is_still_fit_to_be_shown() {
    let mut small = still(7);
    small.curves.iter_mut().for_each(|curve| curve.points.truncate(4));
    let scenes = [0, 1].map(|frame| ToPreview::Scene(Scene { still: Arc::new(small.clone()), now: now(frame) }));
    let good = scene_bytes(&scenes);
    let mut random = Seeded(1);
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..20_000 {
        let mut bytes = good.clone();
        random.spoil(&mut bytes);
        let (got, end) = read_scenes(&bytes[..]);
        for message in &got {
            if let ToPreview::Scene(scene) = message {
                assert_eq!(check_scene(scene), Ok(()));
            }
        }
        if end.is_ok() { accepted += 1 } else { refused += 1 }
    }
    // Flipping a bit of a coordinate often leaves a number; hitting a count or an index does not.
    assert!(refused > 1000 && accepted > 1000, "{refused} refused, {accepted} accepted");

    let good = event_bytes(&events());
    let refused = (0..20_000)
        .filter(|_| {
            let mut bytes = good.clone();
            random.spoil(&mut bytes);
            read_events(&bytes[..]).1.is_err()
        })
        .count();
    assert!(refused > 1000, "{refused} refused");
}
