//! Two links in a vertical plane by the closed form of a textbook (Spong, Hutchinson and Vidyasagar, Robot Modeling and Control,
//! 2006, example 7.2), and their log. Nothing of it is the library's.

/// The arm as its maker describes it: turning positively lifts a link.
pub(super) const URDF: &str = r#"<robot name="two-links">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.2 0 0"/> <mass value="3"/>
      <inertia ixx="0.002" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0.15 0 0"/> <mass value="2"/>
      <inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="upper"/> <axis xyz="0 -1 0"/>
    <limit lower="-4" upper="4" effort="200" velocity="5"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0"/> <parent link="upper"/> <child link="fore"/> <axis xyz="0 -1 0"/>
    <limit lower="-4" upper="4" effort="100" velocity="5"/>
  </joint>
  <joint name="flange" type="fixed"> <origin xyz="0.3 0 0"/> <parent link="fore"/> <child link="tool"/> </joint>
</robot>
"#;

/// The same with armatures.
pub(super) const MJCF: &str = r#"<mujoco model="two-links">
  <compiler angle="radian"/>
  <worldbody>
    <body name="upper">
      <inertial pos="0.2 0 0" mass="3" diaginertia="0.002 0.05 0.05"/>
      <joint name="shoulder" axis="0 -1 0" range="-4 4" armature="0.3"/>
      <body name="fore" pos="0.4 0 0">
        <inertial pos="0.15 0 0" mass="2" diaginertia="0.001 0.02 0.02"/>
        <joint name="elbow" axis="0 -1 0" range="-4 4" armature="0.1"/>
        <site name="tool" pos="0.3 0 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"#;

const ROWS: usize = 4000;
const STEP_S: f64 = 0.005;

/// What the true arm has besides its description.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Arm {
    /// At the flange \[kg\].
    pub(super) payload_kg: f64,
    /// Of the second link, as a share of it.
    pub(super) heavier: f64,
    /// Armature of the first joint \[kg m^2\].
    pub(super) armature_kgm2: f64,
    /// How far the mount is tilted in the plane \[rad\].
    pub(super) tilt_rad: f64,
    /// The second joint stands still.
    pub(super) rests: bool,
}

/// Columns of a log.
#[derive(Debug, Clone)]
pub(super) struct Log {
    pub(super) time_s: Vec<f64>,
    pub(super) theta_rad: [Vec<f64>; 2],
    pub(super) torque_nm: [Vec<f64>; 2],
    /// None of most logs.
    pub(super) command_rad: Option<[Vec<f64>; 2]>,
}

type Courses = [[(f64, f64); 6]; 2];

/// Gains of drives that hold the nominal weights as well: stiffness \[N m/rad\] and damping \[N m s/rad\].
const GAINS: [(f64, f64); 2] = [(700.0, 45.0), (260.0, 15.0)];

fn courses(arm: Arm, noise: &mut Noise) -> Courses {
    let mut courses = [[(0.0, 0.0); 6]; 2];
    for (size, phase) in courses.iter_mut().flatten() {
        *size = 0.05 + 0.2 * noise.uniform();
        *phase = std::f64::consts::TAU * noise.uniform();
    }
    if arm.rests {
        courses[1] = [(0.0, 0.0); 6];
    }
    courses
}

impl Log {
    /// 20 s at 200 Hz; `seed` makes motion and noise.
    pub(super) fn of(arm: Arm, seed: u64) -> Self {
        let mut noise = Noise(seed);
        let courses = courses(arm, &mut noise);
        let mut log = Self {
            time_s: Vec::new(),
            theta_rad: [Vec::new(), Vec::new()],
            torque_nm: [Vec::new(), Vec::new()],
            command_rad: None,
        };
        for row in 0..ROWS {
            let time = STEP_S * row as f64;
            let state = courses.map(|course| motion(&course, time));
            let torque = torque(&arm, state);
            log.time_s.push(time);
            for joint in 0..2 {
                log.theta_rad[joint].push((state[joint][0] * 1e6).round() * 1e-6);
                log.torque_nm[joint].push(torque[joint] + 0.1 * noise.normal());
            }
        }
        log
    }

    /// The same with the commands that drives of these gains made these torques of, which they heard late.
    pub(super) fn commanded(arm: Arm, seed: u64, late_s: f64) -> Self {
        let mut log = Self::of(arm, seed);
        let courses = courses(arm, &mut Noise(seed));
        let fine_s = 2.5e-4;
        let commands = [0, 1].map(|joint| {
            let (stiffness, damping) = GAINS[joint];
            // tau = K (u - q) + D (du/dt - w) + g: the speed that the command u has to have
            let speed = |time: f64, heard: f64| {
                let state = courses.map(|course| motion(&course, time));
                let still = state.map(|own| [own[0], 0.0, 0.0]);
                let driven = torque(&arm, state)[joint] - torque(&Arm::default(), still)[joint];
                let [angle, own_speed, _] = state[joint];
                own_speed + (driven - stiffness * (heard - angle)) / damping
            };
            let mut heard = vec![motion(&courses[joint], 0.0)[0]];
            for step in 0..(ROWS * 20 + 1000) {
                let (time, own) = (fine_s * step as f64, heard[step]);
                let middle = own + 0.5 * fine_s * speed(time, own);
                heard.push(own + fine_s * speed(time + 0.5 * fine_s, middle));
            }
            // what is heard now was sent before
            let ahead = (late_s / fine_s).round() as usize;
            (0..ROWS).map(|row| heard[20 * row + ahead]).collect()
        });
        log.command_rad = Some(commands);
        log
    }

    pub(super) fn text(&self) -> String {
        let mut text = "t_s,theta1_rad,theta2_rad,torque1_nm,torque2_nm".to_owned();
        if self.command_rad.is_some() {
            text.push_str(",command1_rad,command2_rad");
        }
        text.push('\n');
        let mut columns = vec![&self.time_s];
        columns.extend(self.theta_rad.iter().chain(&self.torque_nm));
        columns.extend(self.command_rad.iter().flatten());
        for row in 0..self.time_s.len() {
            // NaN is written as an empty cell
            let cells = columns.iter().map(|own| match own[row].is_nan() {
                true => String::new(),
                false => own[row].to_string(),
            });
            text.push_str(&cells.collect::<Vec<_>>().join(","));
            text.push('\n');
        }
        text
    }
}

/// Position, velocity and acceleration of a joint.
fn motion(course: &[(f64, f64)], time: f64) -> [f64; 3] {
    let mut own = [0.0; 3];
    for (k, (size, phase)) in course.iter().enumerate() {
        let rate = std::f64::consts::TAU * (0.1 + 0.15 * k as f64);
        let (sine, cosine) = (rate * time + phase).sin_cos();
        own[0] += size * sine;
        own[1] += size * rate * cosine;
        own[2] -= size * rate * rate * sine;
    }
    own
}

fn torque(arm: &Arm, [[q1, w1, a1], [q2, w2, a2]]: [[f64; 3]; 2]) -> [f64; 2] {
    let (l1, l2, c1, c2) = (0.4, 0.3, 0.2, 0.15);
    let (m1, m2, p) = (3.0, 2.0 * (1.0 + arm.heavier), arm.payload_kg);
    let (i1, i2) = (0.05, 0.02 * (1.0 + arm.heavier));
    // second link and payload together about the second joint
    let moment = m2 * c2 + p * l2;
    let about = m2 * c2 * c2 + i2 + p * l2 * l2;
    let (sine, cosine) = q2.sin_cos();
    let d11 = m1 * c1 * c1 + i1 + (m2 + p) * l1 * l1 + about + 2.0 * l1 * moment * cosine;
    let d12 = about + l1 * moment * cosine;
    let h = -l1 * moment * sine;
    let g = 9.81;
    let g2 = moment * g * (q1 + q2 + arm.tilt_rad).cos();
    let g1 = (m1 * c1 + (m2 + p) * l1) * g * (q1 + arm.tilt_rad).cos() + g2;
    let friction = |w: f64, coulomb: f64, viscous: f64| coulomb * (w / 0.006).tanh() + viscous * w;
    [
        d11 * a1
            + d12 * a2
            + h * (2.0 * w1 * w2 + w2 * w2)
            + g1
            + (0.3 + arm.armature_kgm2) * a1
            + friction(w1, 1.5, 0.8),
        d12 * a1 + about * a2 - h * w1 * w1 + g2 + 0.1 * a2 + friction(w2, 0.6, 0.3),
    ]
}

/// Numbers that look random: splitmix64 (Steele, Lea, Flood, 2014).
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal with standard deviation 1: the sum of twelve.
    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
