// Forward kinematics and 6x7 Jacobian of a chain by Pinocchio: a peer of `cargo xtask bench-peers`.
//
// usage: pinocchio_kinematics FILE   (formats: bench_peers/files.rs, bench_peers/protocol.rs)
// A request is one line `CALL POSES CALLS REPEATS`: the first POSES poses of the file, one after the
// other, CALLS times over; that REPEATS times, each timed. The answer is one line of JSON. CALL is
//   joint   computeJointJacobians, updateFramePlacement, getFrameJacobian
//   frame   computeFrameJacobian, which does the handle's branch alone (here: the whole chain)
//   values  as joint, not timed; the answer has the pose (rows of [R p]) and the Jacobian (rows) of each.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace pin = pinocchio;
using Clock = std::chrono::steady_clock;
using Jacobian = Eigen::Matrix<double, 6, 7>;
constexpr int kJoints = 7;
constexpr int kRows = kJoints + 1;
constexpr int kFree = 28;

int main(int count, char** paths) {
  std::ifstream file(count == 2 ? paths[1] : "", std::ios::binary | std::ios::ate);
  std::vector<double> all(file ? static_cast<size_t>(file.tellg()) / sizeof(double) : 0);
  file.seekg(0);
  file.read(reinterpret_cast<char*>(all.data()), all.size() * sizeof(double));
  const size_t head = 2 + 4 * kRows + kFree;
  if (!file || all.size() < head || all.size() != head + kRows * static_cast<size_t>(all[0])) {
    std::fprintf(stderr, "usage: pinocchio_kinematics FILE, a file of distances\n");
    return 2;
  }
  // Row i: A_i = Rz(theta_i) T(a_i, 0, d_i) Rx(alpha_i). Joint i turns after the constant part of the
  // rows before it and its own theta_i; row 0 has no joint.
  pin::Model model;
  pin::JointIndex parent = 0;
  pin::SE3 offset = pin::SE3::Identity();
  for (int i = 0; i < kRows; ++i) {
    const double a = all[2 + 4 * i], alpha = all[3 + 4 * i], d = all[4 + 4 * i], theta = all[5 + 4 * i];
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero(), slide(a, 0.0, d);
    const Eigen::Matrix3d turn(Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitZ()));
    const Eigen::Matrix3d twist(Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()));
    offset = offset * pin::SE3(turn, zero);
    if (i > 0) {
      parent = model.addJoint(parent, pin::JointModelRZ(), offset, "joint" + std::to_string(i));
      offset = pin::SE3::Identity();
    }
    offset = offset * pin::SE3(twist, slide);
  }
  const auto handle = model.addFrame(pin::Frame("handle", parent, 0, offset, pin::OP_FRAME));
  pin::Data data(model);
  std::vector<Eigen::VectorXd> poses;
  for (size_t first = head; first < all.size(); first += kRows)
    poses.push_back(Eigen::Map<Eigen::VectorXd>(&all[first], kJoints));
  std::vector<pin::SE3> placements(poses.size(), pin::SE3::Identity());
  std::vector<Jacobian> jacobians(poses.size(), Jacobian::Zero());

  const auto joint = [&](size_t i) {
    pin::computeJointJacobians(model, data, poses[i]);
    placements[i] = pin::updateFramePlacement(model, data, handle);
    pin::getFrameJacobian(model, data, handle, pin::LOCAL_WORLD_ALIGNED, jacobians[i]);
  };
  const auto frame = [&](size_t i) {
    pin::computeFrameJacobian(model, data, poses[i], handle, pin::LOCAL_WORLD_ALIGNED, jacobians[i]);
    placements[i] = data.oMf[handle];
  };
  const auto time = [](const auto& call, size_t size, int calls) {
    const auto start = Clock::now();
    for (int again = 0; again < calls; ++again)
      for (size_t i = 0; i < size; ++i) call(i);
    return std::chrono::duration<double>(Clock::now() - start).count();
  };

  std::printf("{\"version\":\"Pinocchio %s, Eigen %d.%d.%d\"}\n", PINOCCHIO_VERSION, EIGEN_WORLD_VERSION,
              EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  std::fflush(stdout);
  std::string name;
  size_t size;
  int calls, repeats;
  while (std::cin >> name >> size >> calls >> repeats) {
    size = std::min(size, poses.size());
    const char* before = "[";
    if (name == "values" || name == "frame-values") {
      for (size_t i = 0; i < size; ++i) name == "values" ? joint(i) : frame(i);
      std::printf("{\"values\":");
      for (size_t i = 0; i < size; ++i) {
        Eigen::Matrix<double, 3, 4> pose;
        pose << placements[i].rotation(), placements[i].translation();
        for (int k = 0; k < 12; ++k, before = ",") std::printf("%s%.17g", before, pose(k / 4, k % 4));
        for (int k = 0; k < 42; ++k) std::printf(",%.17g", jacobians[i](k / 7, k % 7));
      }
    } else {
      std::printf("{\"solve_s\":");
      for (int repeat = 0; repeat < repeats; ++repeat, before = ",")
        std::printf("%s%.9g", before, name == "joint" ? time(joint, size, calls) : time(frame, size, calls));
    }
    std::printf("]}\n");
    std::fflush(stdout);
  }
}
