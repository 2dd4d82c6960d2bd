//! A made-up run whose contacts are known, as BVH text.
//!
//! A figure of 1.75 m stands, runs along z and stands. Contacts come first: step `i` is on the ground around the middle
//! of its time, below where the hips then are; feet follow from contacts and the swings between them, legs from hips and
//! feet by the cosine rule. Lengths are centimetres, y is up, left is +x.

use std::{f64::consts::TAU, fmt::Write};

use glam::{DMat3, DVec3};

/// Top of the head of the standing figure.
pub(crate) const STATURE: f64 = 175.0;

const THIGH: f64 = 43.0;

const SHANK: f64 = 43.0;

/// Points of a flat foot, from the ground below the ankle; left and right are alike.
const ANKLE: DVec3 = DVec3::new(0.0, 7.0, 0.0);

const BALL: DVec3 = DVec3::new(0.0, 2.0, 13.0);

const HEEL: DVec3 = DVec3::new(0.0, 0.0, -5.0);

/// Hip joints beside and below the root.
const HIP: (f64, f64) = (8.5, 6.0);

/// The hips are at least this high over the ground.
const LOWEST_HIPS: f64 = 62.0;

/// Pitch of the foot at toe-off and where it is most, heel up.
const TOE_OFF_DEG: f64 = 52.0;

const MOST_PITCH_DEG: f64 = 95.0;

/// A foot leaves the ground and comes down at these speeds, statures per second up and down …
const UP: f64 = 0.3;

const DOWN: f64 = 0.4;

/// … and at these shares of the running speed, forward.
const AHEAD: (f64, f64) = (0.05, 0.08);

/// Seconds of standing before and after.
const STAND_SECS: f64 = 0.5;

/// Steps at full speed.
const N_STEADY: usize = 6;

/// How a foot lands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Landing {
    /// On the heel, about which it comes down.
    Heel,
    /// On the ball, the heel comes down after it.
    Forefoot,
}

/// What is to be run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Frames a second.
    pub(crate) fps: f64,
    /// Statures per second.
    pub(crate) speed: f64,
    /// Seconds of each contact.
    pub(crate) contact_secs: f64,
    /// Seconds between one foot's contact and the other's.
    pub(crate) flight_secs: f64,
    pub(crate) landing: Landing,
    /// Joints are off by up to this in each direction.
    pub(crate) noise: f64,
    /// A foot slides forward by this in each contact.
    pub(crate) slip: f64,
    /// Of the noise.
    pub(crate) seed: u32,
}

/// Where a foot is, without noise.
#[derive(Clone, Copy)]
struct Foot {
    ankle: DVec3,
    pitch_rad: f64,
    toe_pitch_rad: f64,
}

/// A contact of a foot.
#[derive(Clone, Copy)]
struct Contact {
    /// Middle of the time over which it would last if nobody stood.
    middle_secs: f64,
    usual_secs: f64,
    begin_secs: f64,
    end_secs: f64,
    place: DVec3,
}

impl Run {
    /// Returns the contacts, left foot and right foot: first and last frame of each.
    pub(crate) fn contacts(&self) -> [Vec<(usize, usize)>; 2] {
        let frames = |c: &Contact| {
            let last = (c.end_secs * self.fps + 1e-9).floor() as usize;
            ((c.begin_secs * self.fps - 1e-9).ceil() as usize, last.min(self.n_frames() - 1))
        };
        [0, 1].map(|side| self.contacts_of(side).iter().map(frames).collect())
    }

    /// Returns the clip.
    pub(crate) fn text(&self) -> String {
        let mut text = String::from("HIERARCHY\n");
        let mut depth = 0;
        for &(name, parent_depth, offset) in &JOINTS {
            while depth > parent_depth {
                depth -= 1;
                text += "}\n";
            }
            let [x, y, z] = offset;
            let kind = if parent_depth == 0 { "ROOT" } else { "JOINT" };
            let _ = match name {
                "" => write!(text, "End Site\n{{\nOFFSET {x} {y} {z}\n}}\n"),
                _ => {
                    depth += 1;
                    let places = if parent_depth == 0 { "6 Xposition Yposition Zposition" } else { "3" };
                    write!(
                        text,
                        "{kind} {name}\n{{\nOFFSET {x} {y} {z}\nCHANNELS {places} Zrotation Xrotation Yrotation\n"
                    )
                }
            };
        }
        text += &"}\n".repeat(depth);
        let _ = write!(text, "MOTION\nFrames: {}\nFrame Time: {:.9}\n", self.n_frames(), 1.0 / self.fps);
        let hips = self.height_of_hips();
        for frame in 0..self.n_frames() {
            for channel in self.channels(frame, hips) {
                let _ = write!(text, "{channel:.5} ");
            }
            text += "\n";
        }
        text
    }

    fn step_secs(&self) -> f64 {
        self.contact_secs + self.flight_secs
    }

    /// Steps in which the figure gets up to speed, or slows down.
    fn n_ramp(&self) -> usize {
        2 + self.speed.round() as usize
    }

    /// Steps, the two that stand before and the two that stand after included.
    fn n_steps(&self) -> usize {
        3 + 2 * self.n_ramp() + N_STEADY
    }

    fn middle_secs(&self, step: usize) -> f64 {
        STAND_SECS + step as f64 * self.step_secs()
    }

    fn n_frames(&self) -> usize {
        ((self.middle_secs(self.n_steps() - 1) + 0.5 * self.contact_secs + STAND_SECS) * self.fps) as usize
    }

    /// Returns how far the hips have run, and their speed over the full one.
    fn progress(&self, secs: f64) -> (f64, f64) {
        let ramp = self.n_ramp() as f64 * self.step_secs();
        let after = |from: f64| {
            let p = ((secs - from) / ramp).clamp(0.0, 1.0);
            let gone = ramp * (p.powi(3) - 0.5 * p.powi(4)) + (secs - from - ramp).max(0.0);
            (gone, p * p * (3.0 - 2.0 * p))
        };
        let (up, down) = (after(self.middle_secs(0)), after(self.middle_secs(self.n_steps() - 1) - ramp));
        (STATURE * self.speed * (up.0 - down.0), up.1 - down.1)
    }

    fn contacts_of(&self, side: usize) -> Vec<Contact> {
        let n = self.n_steps();
        let contact = |step: usize| {
            let middle_secs = self.middle_secs(step);
            let (gone, pace) = self.progress(middle_secs);
            let ahead = 0.06 * self.speed * self.contact_secs * STATURE * pace;
            // Slow steps hardly leave the ground.
            let half = 0.5 * (self.contact_secs + 0.8 * (1.0 - pace) * self.flight_secs);
            let aside = if side == 0 { 1.0 } else { -1.0 } * (8.0 - 4.0 * pace);
            Contact {
                middle_secs,
                usual_secs: 2.0 * half,
                begin_secs: if step < 2 { 0.0 } else { middle_secs - half },
                end_secs: if step + 2 < n { middle_secs + half } else { f64::from(u16::MAX) },
                place: DVec3::new(aside, 0.0, gone + ahead),
            }
        };
        (side..n).step_by(2).map(contact).collect()
    }

    /// Returns a foot's pitch in a contact, `u` of its time gone: positive with the heel up.
    fn pitch_rad(&self, u: f64) -> f64 {
        let down = (1.0 - u / 0.25).clamp(0.0, 1.0).powi(2);
        let lands_deg = if self.landing == Landing::Heel { -17.0 } else { 13.0 };
        (lands_deg * down + TOE_OFF_DEG * ((u - 0.5) / 0.5).clamp(0.0, 1.0).powf(1.7)).to_radians()
    }

    /// Returns a foot in a contact: it turns about its heel when pitched up, about its ball when pitched down.
    fn in_contact(&self, contact: &Contact, secs: f64) -> Foot {
        let u = 0.5 + (secs - contact.middle_secs) / contact.usual_secs;
        let stands = contact.end_secs - contact.begin_secs > 1.01 * contact.usual_secs;
        let u = match stands {
            true if contact.begin_secs == 0.0 => u.max(0.45),
            true => u.min(0.45),
            false => u,
        };
        let pitch_rad = self.pitch_rad(u);
        let pivot = if pitch_rad < 0.0 { HEEL } else { BALL };
        let slid = if stands { 0.0 } else { self.slip * u };
        let ankle = contact.place + slid * DVec3::Z + pivot + DMat3::from_rotation_x(pitch_rad) * (ANKLE - pivot);
        Foot { ankle, pitch_rad, toe_pitch_rad: -pitch_rad.max(0.0) }
    }

    /// Returns a foot between two contacts.
    fn in_swing(&self, before: &Contact, after: &Contact, secs: f64) -> Foot {
        let (last, next) = (self.in_contact(before, before.end_secs), self.in_contact(after, after.begin_secs));
        let swing_secs = after.begin_secs - before.end_secs;
        let s = (secs - before.end_secs) / swing_secs;
        let ball = |foot: &Foot| foot.ankle + DMat3::from_rotation_x(foot.pitch_rad) * (BALL - ANKLE);
        let pace = self.progress(secs).1;
        let speed = swing_secs * STATURE;
        let lift = 16.0 * (0.03 + 0.02 * self.speed * pace) * STATURE * (s * (1.0 - s)).powi(2)
            + speed * (UP * s * (1.0 - s).powi(2) + DOWN * s * s * (1.0 - s));
        let ahead = speed * self.speed * pace * (AHEAD.0 * s * (1.0 - s).powi(2) - AHEAD.1 * s * s * (1.0 - s));
        let place = ball(&last).lerp(ball(&next), ease(s)) + DVec3::new(0.0, lift, ahead);
        let most = MOST_PITCH_DEG.to_radians() * (0.5 + 0.5 * pace);
        let pitch_rad = if s < 0.35 {
            last.pitch_rad + (most - last.pitch_rad) * ease(s / 0.35)
        } else {
            most + (next.pitch_rad - most) * ease((s - 0.35) / 0.65)
        };
        let relaxed = 1.0 - ease((s / 0.3).min(1.0));
        let ready = ease(((s - 0.8) / 0.2).max(0.0));
        Foot {
            ankle: place - DMat3::from_rotation_x(pitch_rad) * (BALL - ANKLE),
            pitch_rad,
            toe_pitch_rad: relaxed * last.toe_pitch_rad + ready * next.toe_pitch_rad,
        }
    }

    fn foot(&self, side: usize, secs: f64) -> Foot {
        let contacts = self.contacts_of(side);
        let at = contacts.iter().rposition(|c| c.begin_secs <= secs).expect("a foot stands at first");
        if secs <= contacts[at].end_secs {
            self.in_contact(&contacts[at], secs)
        } else {
            self.in_swing(&contacts[at], &contacts[at + 1], secs)
        }
    }

    /// Returns how high the root is on average: as high as the legs allow in contacts.
    fn height_of_hips(&self) -> f64 {
        let mut height = THIGH + SHANK + ANKLE.y + HIP.1 - 2.0;
        for frame in 0..self.n_frames() {
            let secs = frame as f64 / self.fps;
            for side in 0..2 {
                let foot = self.foot(side, secs);
                while height > LOWEST_HIPS
                    && self.hip(side, secs, height).distance(foot.ankle) > 0.985 * (THIGH + SHANK)
                {
                    height -= 0.5;
                }
            }
        }
        height
    }

    /// Returns the root's place and orientation.
    fn root(&self, secs: f64, height: f64) -> (DVec3, DMat3) {
        let (gone, pace) = self.progress(secs);
        let phase = TAU * (secs - STAND_SECS) / self.step_secs();
        // As much as gravity would throw the body up and down at this rate of steps.
        let bob = 981.0 * (self.step_secs() / TAU).powi(2) * pace;
        let turn = DMat3::from_rotation_y(0.12 * pace * (0.5 * phase).cos()) * DMat3::from_rotation_x(0.12 * pace);
        (DVec3::new(1.5 * pace * (0.5 * phase).cos(), height - bob * phase.cos(), gone), turn)
    }

    fn hip(&self, side: usize, secs: f64, height: f64) -> DVec3 {
        let (place, turn) = self.root(secs, height);
        place + turn * DVec3::new(if side == 0 { HIP.0 } else { -HIP.0 }, -HIP.1, 0.0)
    }

    /// Returns one frame's channels.
    fn channels(&self, frame: usize, height: f64) -> Vec<f64> {
        let secs = frame as f64 / self.fps;
        let pace = self.progress(secs).1;
        let noise = |which: u32| noise(self.seed ^ (frame as u32 * 16 + which).wrapping_mul(0x9e37_79b9));
        let off = |which: u32| self.noise * DVec3::new(noise(which), noise(which + 1), noise(which + 2));
        let (place, root) = self.root(secs, height);
        let place = place + off(0);
        let stride = 0.5 * TAU * (secs - STAND_SECS) / self.step_secs();
        let mut locals = vec![root, DMat3::from_rotation_x(0.05 * pace), DMat3::from_rotation_x(-0.1 * pace)];
        for sign in [1.0, -1.0] {
            let swing = 0.7 * pace * sign * stride.cos();
            locals.push(DMat3::from_rotation_z(0.15 * sign) * DMat3::from_rotation_x(swing));
            locals.push(DMat3::from_rotation_x(-0.2 - 1.2 * pace));
        }
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let Foot { ankle, pitch_rad, toe_pitch_rad } = self.foot(side, secs);
            let ankle = ankle + off(3 + 4 * side as u32);
            let pitch_rad = pitch_rad + self.noise / BALL.z * noise(6 + 4 * side as u32);
            let down = ankle - (place + root * DVec3::new(sign * HIP.0, -HIP.1, 0.0));
            let reach = down.length().min(THIGH + SHANK - 0.05);
            let up = -down.normalize();
            let across = up.cross(DVec3::Z).normalize();
            let plane = DMat3::from_cols(across, up, across.cross(up));
            let bend = (0.5 * reach / THIGH).acos();
            let (thigh, shank) = (plane * DMat3::from_rotation_x(-bend), plane * DMat3::from_rotation_x(bend));
            locals.push(root.transpose() * thigh);
            locals.push(DMat3::from_rotation_x(2.0 * bend));
            locals.push(shank.transpose() * DMat3::from_rotation_x(pitch_rad));
            locals.push(DMat3::from_rotation_x(toe_pitch_rad));
        }
        let mut channels = place.to_array().to_vec();
        channels.extend(locals.iter().flat_map(zxy_deg));
        channels
    }
}

/// Name, depth and offset of every joint; end sites have no name.
const JOINTS: [(&str, usize, [f64; 3]); 20] = [
    ("Hips", 0, [0.0; 3]),
    ("Chest", 1, [0.0, 18.0, 0.0]),
    ("Head", 2, [0.0, 36.0, 0.0]),
    ("", 3, [0.0, 24.0, 0.0]),
    ("LeftArm", 2, [17.0, 30.0, 0.0]),
    ("LeftForeArm", 3, [0.0, -29.0, 0.0]),
    ("", 4, [0.0, -40.0, 0.0]),
    ("RightArm", 2, [-17.0, 30.0, 0.0]),
    ("RightForeArm", 3, [0.0, -29.0, 0.0]),
    ("", 4, [0.0, -40.0, 0.0]),
    ("LeftUpLeg", 1, [HIP.0, -HIP.1, 0.0]),
    ("LeftLeg", 2, [0.0, -THIGH, 0.0]),
    ("LeftFoot", 3, [0.0, -SHANK, 0.0]),
    ("LeftToeBase", 4, [0.0, BALL.y - ANKLE.y, BALL.z]),
    ("", 5, [0.0, -1.0, 6.0]),
    ("RightUpLeg", 1, [-HIP.0, -HIP.1, 0.0]),
    ("RightLeg", 2, [0.0, -THIGH, 0.0]),
    ("RightFoot", 3, [0.0, -SHANK, 0.0]),
    ("RightToeBase", 4, [0.0, BALL.y - ANKLE.y, BALL.z]),
    ("", 5, [0.0, -1.0, 6.0]),
];

/// From 0 to 1, slow at both ends.
fn ease(s: f64) -> f64 {
    s * s * (3.0 - 2.0 * s)
}

/// Degrees about z, x and y whose product, in this order, is the rotation.
fn zxy_deg(r: &DMat3) -> [f64; 3] {
    let x = r.y_axis.z.clamp(-1.0, 1.0).asin();
    [(-r.y_axis.x).atan2(r.y_axis.y), x, (-r.x_axis.z).atan2(r.z_axis.z)].map(f64::to_degrees)
}

/// From −1 to 1, another for every seed.
fn noise(seed: u32) -> f64 {
    let mut x = seed.wrapping_add(0x9e37_79b9);
    for _ in 0..2 {
        x = (x ^ (x >> 16)).wrapping_mul(0x21f0_aaad);
        x = (x ^ (x >> 15)).wrapping_mul(0x735a_2d97);
    }
    f64::from(x) / f64::from(u32::MAX) * 2.0 - 1.0
}
