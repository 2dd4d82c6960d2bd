//! The figure: joints, sizes and the BVH text around its rows.
//!
//! A man of 1.75 m by Winter's shares of the stature, rounded. At rest it stands straight with arms hanging.

use std::fmt::Write;

/// Top of the head of the standing figure.
pub(super) const STATURE: f64 = 175.0;

/// From hip to knee: 0.245 of the stature.
pub(super) const THIGH: f64 = 42.9;

/// From knee to ankle: 0.246 of the stature.
pub(super) const SHANK: f64 = 43.0;

/// Ankle over the ground, foot flat: 0.039 of the stature.
pub(super) const ANKLE_HEIGHT: f64 = 6.8;

/// From the ankle to the toe joint, foot flat: forward, and down.
pub(super) const ANKLE_TO_TOE: (f64, f64) = (12.0, 5.0);

/// From the ankle back to where the heel meets the ground.
pub(super) const HEEL_BEHIND_ANKLE: f64 = 5.0;

/// Hip joints over the ground when standing, knees a little bent.
pub(super) const STANDING_HIP_HEIGHT: f64 = ANKLE_HEIGHT + THIGH + SHANK - 0.65;

/// From the root to a hip joint: outward, and down.
pub(super) const ROOT_TO_HIP: (f64, f64) = (8.7, 5.0);

/// A joint of the figure in the order of the file.
struct Part {
    name: &'static str,
    /// Blocks that end before this joint begins, counted from its predecessor's.
    closes: usize,
    offset: [f64; 3],
    end_site: Option<[f64; 3]>,
}

const fn part(name: &'static str, closes: usize, offset: [f64; 3], end_site: Option<[f64; 3]>) -> Part {
    Part { name, closes, offset, end_site }
}

/// Number of joints.
pub(super) const N_JOINTS: usize = 21;

/// Parents first; both arms hang on the chest, both legs on the root.
const PARTS: [Part; N_JOINTS] = [
    part("Hips", 0, [0.0, 0.0, 0.0], None),
    part("Spine", 0, [0.0, 8.0, -1.0], None),
    part("Chest", 0, [0.0, 17.0, 0.0], None),
    part("Neck", 0, [0.0, 25.0, 0.0], None),
    part("Head", 0, [0.0, 9.0, 1.5], Some([0.0, HEAD, 0.0])),
    part("LeftCollar", 2, [2.5, 20.0, 0.5], None),
    part("LeftShoulder", 0, [15.5, -1.5, -0.5], None),
    part("LeftElbow", 0, [0.0, -32.5, 0.0], None),
    part("LeftWrist", 0, [0.0, -25.5, 0.0], Some([0.0, -18.0, 0.0])),
    part("RightCollar", 4, [-2.5, 20.0, 0.5], None),
    part("RightShoulder", 0, [-15.5, -1.5, -0.5], None),
    part("RightElbow", 0, [0.0, -32.5, 0.0], None),
    part("RightWrist", 0, [0.0, -25.5, 0.0], Some([0.0, -18.0, 0.0])),
    part("LeftHip", 6, [ROOT_TO_HIP.0, -ROOT_TO_HIP.1, 0.0], None),
    part("LeftKnee", 0, [0.0, -THIGH, 0.0], None),
    part("LeftAnkle", 0, [0.0, -SHANK, 0.0], None),
    part("LeftToe", 0, [0.0, -ANKLE_TO_TOE.1, ANKLE_TO_TOE.0], Some([0.0, -0.8, 7.0])),
    part("RightHip", 4, [-ROOT_TO_HIP.0, -ROOT_TO_HIP.1, 0.0], None),
    part("RightKnee", 0, [0.0, -THIGH, 0.0], None),
    part("RightAnkle", 0, [0.0, -SHANK, 0.0], None),
    part("RightToe", 0, [0.0, -ANKLE_TO_TOE.1, ANKLE_TO_TOE.0], Some([0.0, -0.8, 7.0])),
];

/// From the head joint to the top of the head: what the stature leaves.
const HEAD: f64 = STATURE - STANDING_HIP_HEIGHT - ROOT_TO_HIP.1 - 8.0 - 17.0 - 25.0 - 9.0;

/// Channels of one frame: the root's place, then each joint's ZXY angles.
pub(super) type Row = [f64; 3 + 3 * N_JOINTS];

/// Writes the file; six decimals keep a planted foot where it is to a millionth of the stature and better.
pub(super) fn text(rows: &[Row]) -> String {
    let mut out = String::from("HIERARCHY\n");
    let mut depth = 0;
    for (i, part) in PARTS.iter().enumerate() {
        close(&mut out, &mut depth, part.closes);
        let (keyword, channels) = match i {
            0 => ("ROOT", "6 Xposition Yposition Zposition"),
            _ => ("JOINT", "3"),
        };
        line(&mut out, depth, &format!("{keyword} {}", part.name));
        line(&mut out, depth, "{");
        depth += 1;
        line(&mut out, depth, &offset(part.offset));
        line(&mut out, depth, &format!("CHANNELS {channels} Zrotation Xrotation Yrotation"));
        if let Some(end_site) = part.end_site {
            line(&mut out, depth, "End Site");
            line(&mut out, depth, "{");
            line(&mut out, depth + 1, &offset(end_site));
            line(&mut out, depth, "}");
        }
    }
    let n_open = depth;
    close(&mut out, &mut depth, n_open);
    write!(out, "MOTION\nFrames: {}\nFrame Time: 0.016666667\n", rows.len()).expect("writing to memory");
    for row in rows {
        for (i, value) in row.iter().enumerate() {
            // Adding zero takes the sign from a negative one.
            let rounded = (value * 1e6).round() / 1e6 + 0.0;
            write!(out, "{}{rounded:.6}", if i == 0 { "" } else { " " }).expect("writing to memory");
        }
        out.push('\n');
    }
    out
}

fn close(out: &mut String, depth: &mut usize, n_blocks: usize) {
    for _ in 0..n_blocks {
        *depth -= 1;
        line(out, *depth, "}");
    }
}

fn line(out: &mut String, depth: usize, text: &str) {
    out.extend(std::iter::repeat_n('\t', depth));
    out.push_str(text);
    out.push('\n');
}

fn offset([x, y, z]: [f64; 3]) -> String {
    format!("OFFSET {x:.4} {y:.4} {z:.4}")
}
