//! Scenario S7: the tip of a two-joint arm draws a circle in its plane.
//!
//! ```text
//! p(t) = c + R*(cos psi, sin psi),  psi = psi_0 + phi(t),  d phi/dt = w(t)*2*pi/T
//! p    = l1*(cos q1, sin q1) + l2*(cos(q1 + q2), sin(q1 + q2))
//! ```
//!
//! The circle begins at the tip of the arm's start, with its centre c on the line from there to the base. w rises smoothly from 0 to 1
//! over the first [`RAMP`], and falls at the end; the laps between count. p is solved for q1 and q2 with the elbow on the side of the
//! start, order by order of their Taylor series ([`super::jet`]), so that jerk and snap of the setpoints are exact. Axes parallel. q1 and q2 count
//! from where both links, from axis to axis and to the tip, lie along x: [`Circle`] holds what the joints' own zeros are off. Units: rad, m, s.

use std::f64::consts::{PI, TAU};

use super::chain::Link;
use super::file::RobotFile;
use super::jet::{Jet, ORDERS, cosine_and_sine, derivatives, of_derivatives};
use super::motions::RobotTask;
use crate::bench::task::{Demand, integral_of_smooth, smooth};

/// Time in which the tip gets to its speed, and in which it stops (s).
pub const RAMP: f64 = 0.5;
/// Closest that the circle may come to where the arm is stretched or folded, in parts of its longest reach.
const CLEARANCE: f64 = 0.02;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleParams {
    /// R (m).
    pub radius: f64,
    /// T (s).
    pub period: f64,
    /// Laps at full speed.
    pub laps: u32,
}

impl Default for CircleParams {
    /// S7.
    fn default() -> Self {
        Self { radius: 0.1, period: 4.0, laps: 2 }
    }
}

/// A circle for a two-joint arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    params: CircleParams,
    centre: [f64; 2],
    /// psi_0 (rad).
    first: f64,
    lengths: [f64; 2],
    /// Angles of the start (rad).
    start: [f64; 2],
}

/// Largest sine of the angle between axes that count as parallel.
const PARALLEL: f64 = 1e-9;

/// Lengths of both links (m), and the directions in which they lie (rad) at the angle 0 of the joints: of the first from x of its frame,
/// of the second from the first.
fn planar([first, second]: [&Link; 2]) -> ([f64; 2], [f64; 2]) {
    let [ends, directions]: [[f64; 2]; 2] = {
        let places = [first, second].map(|link| [link.end.place[0], link.end.place[1]]);
        [places.map(|[x, y]| x.hypot(y)), places.map(|[x, y]| y.atan2(x))]
    };
    let turned = first.end.axes[0][1].atan2(first.end.axes[0][0]);
    (ends, [directions[0], turned + directions[1] - directions[0]])
}

impl Circle {
    /// The circle of a robot.
    ///
    /// # Errors
    /// One line that names what is out of range, or why the robot can draw none.
    pub fn of(robot: &RobotFile, params: CircleParams) -> Result<Self, String> {
        let [first, second] = robot.joints.as_slice() else {
            return Err(format!("{} joints; a circle is for a robot of 2", robot.joints.len()));
        };
        let [x, y, along] = first.link.end.axes[2];
        if x.hypot(y) > PARALLEL || along < 0.0 {
            let angle = x.hypot(y).atan2(along);
            return Err(format!(
                "the axis of joint 2 is {angle:.4} rad off that of joint 1; a circle is for parallel axes, 0"
            ));
        }
        let (lengths, zeros) = planar([&first.link, &second.link]);
        let start = [first.start + zeros[0], second.start + zeros[1]];
        if let Some(index) = lengths.iter().position(|length| *length == 0.0) {
            return Err(format!(
                "the length of link {} is 0; a circle needs links of some length",
                index + 1
            ));
        }
        let tip = place(lengths, start);
        let distance = tip[0].hypot(tip[1]);
        let circle = Self {
            params,
            centre: tip.map(|along| along * (1.0 - params.radius / distance)),
            first: tip[1].atan2(tip[0]),
            lengths,
            start,
        };
        circle.require_reach(distance)?;
        Ok(circle)
    }

    fn require_reach(&self, farthest: f64) -> Result<(), String> {
        let [l1, l2] = self.lengths;
        let clearance = CLEARANCE * (l1 + l2);
        let (least, most) = ((l1 - l2).abs() + clearance, l1 + l2 - clearance);
        let nearest = farthest - 2.0 * self.params.radius;
        if self.params.radius > 0.0 && nearest >= least && farthest <= most {
            return Ok(());
        }
        Err(format!(
            "a circle of radius {} m from the start is {nearest:.4} to {farthest:.4} m from the base; allowed: {least:.4} to {most:.4} m",
            self.params.radius
        ))
    }

    /// phi.
    fn phase(&self, time: f64) -> Jet {
        let (omega, cruise) = (TAU / self.params.period, f64::from(self.params.laps) * self.params.period);
        let (time, falling) =
            if time > RAMP + cruise { (self.duration() - time, true) } else { (time, false) };
        let x = (time / RAMP).clamp(0.0, 1.0);
        let (w, w1, w2, w3, _) = smooth(x);
        let way = RAMP * integral_of_smooth(x) + (time - RAMP).max(0.0);
        let whole = cruise + RAMP;
        let [way, sign] = if falling { [whole - way, -1.0] } else { [way, 1.0] };
        let slopes = [w, sign * w1 / RAMP, w2 / RAMP.powi(2), sign * w3 / RAMP.powi(3)];
        of_derivatives([way, slopes[0], slopes[1], slopes[2], slopes[3]].map(|value| omega * value))
    }

    /// Jets of q1 and q1 + q2.
    fn directions(&self, time: f64) -> [Jet; 2] {
        let mut psi = self.phase(time);
        psi[0] += self.first;
        let mut place = cosine_and_sine(&psi).map(|jet| jet.map(|term| self.params.radius * term));
        place.iter_mut().zip(self.centre).for_each(|(jet, centre)| jet[0] += centre);
        let mut links: [Jet; 2] = Default::default();
        [links[0][0], links[1][0]] = self.solve([place[0][0], place[1][0]]);
        for order in 1..ORDERS {
            let reached = self.reached(&links);
            let missing = [0, 1].map(|axis: usize| place[axis][order] - reached[axis][order]);
            [links[0][order], links[1][order]] = self.turned_by([links[0][0], links[1][0]], missing);
        }
        links
    }

    /// q1 and q1 + q2 of a place (rad), q1 within half a turn of the start.
    fn solve(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [l1, l2] = self.lengths;
        let cosine = (x * x + y * y - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
        let elbow = cosine.clamp(-1.0, 1.0).acos().copysign(self.start[1]);
        let shoulder = y.atan2(x) - (l2 * elbow.sin()).atan2(l1 + l2 * elbow.cos());
        let off = shoulder - self.start[0];
        let shoulder = self.start[0] + off - TAU * ((off + PI) / TAU).floor();
        [shoulder, shoulder + elbow]
    }

    /// Jets of the tip's place for those of the links' directions.
    fn reached(&self, links: &[Jet; 2]) -> [Jet; 2] {
        let [first, second] = links.each_ref().map(cosine_and_sine);
        let [l1, l2] = self.lengths;
        [0, 1].map(|axis: usize| std::array::from_fn(|k| l1 * first[axis][k] + l2 * second[axis][k]))
    }

    /// By how much the links turn to move the tip by a small way (rad).
    fn turned_by(&self, [first, second]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let [l1, l2] = self.lengths;
        let across = (second - first).sin();
        [
            (second.cos() * x + second.sin() * y) / (l1 * across),
            -(first.cos() * x + first.sin() * y) / (l2 * across),
        ]
    }
}

/// Place of the tip (m) for angles of the joints (rad).
fn place([l1, l2]: [f64; 2], [q1, q2]: [f64; 2]) -> [f64; 2] {
    [l1 * q1.cos() + l2 * (q1 + q2).cos(), l1 * q1.sin() + l2 * (q1 + q2).sin()]
}

impl RobotTask for Circle {
    /// The laps at full speed.
    fn judged(&self) -> [f64; 2] {
        [RAMP, self.duration() - RAMP]
    }

    fn duration(&self) -> f64 {
        f64::from(self.params.laps) * self.params.period + 2.0 * RAMP
    }

    fn at(&self, time: f64) -> Vec<Demand> {
        let [first, second] = self.directions(time.min(self.duration()));
        let elbow = std::array::from_fn(|k| second[k] - first[k]);
        [first, elbow].iter().zip(self.start).map(|(jet, start)| demand(jet, start)).collect()
    }
}

/// Demand of a joint whose bench has its zero at `start` (rad).
fn demand(jet: &Jet, start: f64) -> Demand {
    let [position, velocity, acceleration, jerk, snap] = derivatives(jet);
    Demand { position: position - start, velocity, acceleration, jerk, snap, load: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::chain::Pose;

    fn circle() -> Circle {
        Circle::of(&RobotFile::example(), CircleParams::default()).unwrap()
    }

    /// Demanded place of the tip (m).
    fn tip(circle: &Circle, time: f64) -> [f64; 2] {
        let (sine, cosine) = (circle.first + derivatives(&circle.phase(time))[0]).sin_cos();
        [circle.centre[0] + circle.params.radius * cosine, circle.centre[1] + circle.params.radius * sine]
    }

    fn angles(circle: &Circle, time: f64) -> [f64; 2] {
        let demands = circle.at(time);
        [0, 1].map(|joint: usize| circle.start[joint] + demands[joint].position)
    }

    #[test]
    fn the_tip_is_on_the_circle_and_begins_and_ends_at_the_start() {
        let circle = circle();
        assert_eq!(circle.duration(), 9.0);
        for k in 0..=900 {
            let time = f64::from(k) * 0.01;
            let (found, asked) = (place(circle.lengths, angles(&circle, time)), tip(&circle, time));
            assert!((found[0] - asked[0]).hypot(found[1] - asked[1]) < 1e-12, "{time}");
            assert!(((asked[0] - circle.centre[0]).hypot(asked[1] - circle.centre[1]) - 0.1).abs() < 1e-12);
        }
        let [first, last] = [0.0, circle.duration()].map(|time| circle.at(time));
        assert!(
            first.iter().all(|demand| demand.velocity == 0.0 && demand.position.abs() < 1e-12),
            "{first:?}"
        );
        assert!(last.iter().all(|demand| demand.velocity == 0.0), "{last:?}");
        let [from, to] = circle.judged();
        let way = derivatives(&circle.phase(to))[0] - derivatives(&circle.phase(from))[0];
        assert!((way - 2.0 * TAU).abs() < 1e-9);
    }

    /// Each derivative is the slope of the one before, through both ramps.
    #[test]
    fn derivatives_are_consistent() {
        let circle = circle();
        let of: [fn(&Demand) -> f64; 5] =
            [|d| d.position, |d| d.velocity, |d| d.acceleration, |d| d.jerk, |d| d.snap];
        let h = 1e-5;
        for time in [0.1, 0.37, 0.6, 2.3, 5.0, 8.55, 8.8] {
            for joint in 0..2 {
                for order in 0..4 {
                    let [before, now, after] = [time - h, time, time + h].map(|time| circle.at(time)[joint]);
                    let slope = (of[order](&after) - of[order](&before)) / (2.0 * h);
                    let error = (slope - of[order + 1](&now)).abs();
                    assert!(
                        error < 1e-4 * (1.0 + of[order + 1](&now).abs()),
                        "{time} {joint} {order}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_the_arm_cannot_draw_is_refused() {
        let robot = RobotFile::example();
        let refused = |change: fn(&mut RobotFile), params| {
            let mut robot = robot.clone();
            change(&mut robot);
            Circle::of(&robot, params).unwrap_err()
        };
        let default = CircleParams::default();
        let line = refused(|_| (), CircleParams { radius: 0.4, ..default });
        assert!(line.starts_with("a circle of radius 0.4 m from the start is -0.1"), "{line}");
        let three = |robot: &mut RobotFile| robot.joints.push(robot.joints[0].clone());
        assert_eq!(refused(three, default), "3 joints; a circle is for a robot of 2");
        let twist =
            |robot: &mut RobotFile| robot.joints[0].link.end = Pose::denavit_hartenberg([0.4, 0.0], 0.5);
        let twisted = refused(twist, default);
        assert!(twisted.starts_with("the axis of joint 2 is 0.5000 rad off"), "{twisted}");
        let short = refused(|robot| robot.joints[1].link.end.place[0] = 0.0, default);
        assert!(short.starts_with("the length of link 2 is 0"), "{short}");
    }
}
