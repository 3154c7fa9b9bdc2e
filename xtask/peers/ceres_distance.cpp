// The 28-parameter distance identification by Ceres: a peer of `cargo xtask bench-peers`.
//
// usage: ceres_distance FILE...   (formats: bench_peers/files.rs, bench_peers/protocol.rs)
// A request is one line `FILE DERIVATIVES SOLVER THREADS FUNCTION_TOLERANCE REPEATS`, FILE counted
// from 0; the answer is one line of JSON. Files are read before the first request, never timed.
#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using Clock = std::chrono::steady_clock;
constexpr int kFree = 28;
constexpr int kJoints = 7;
constexpr int kRows = kJoints + 1;
constexpr int kPoseNumbers = kJoints + 1;  // joint variables, distance
constexpr int kTableNumbers = 4 * kRows;   // a, alpha, d, theta of each row
// Poses in one residual block: large blocks share the twists' sines and cost less bookkeeping. One
// pose to a block takes 2 to 4 times as long, 16 to 1024 are alike; two threads need two blocks.
constexpr size_t kBlock = 100;

struct Data {
  std::vector<double> table;   // nominal, home angles included
  std::vector<int> free;       // places of the 28 free parameters in the table
  std::vector<double> poses;   // kPoseNumbers for each
  double sd;                   // standard deviation of a distance [m]
  size_t size() const { return poses.size() / kPoseNumbers; }
};

Data read(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> all(file ? static_cast<size_t>(file.tellg()) / sizeof(double) : 0);
  file.seekg(0);
  file.read(reinterpret_cast<char*>(all.data()), all.size() * sizeof(double));
  const size_t head = 2 + kTableNumbers + kFree;
  if (!file || all.size() < head || all.size() != head + kPoseNumbers * static_cast<size_t>(all[0])) {
    std::fprintf(stderr, "%s is not a file of distances\n", path);
    std::exit(2);
  }
  const double* next = all.data() + 2;
  Data data;
  data.sd = all[1];
  data.table.assign(next, next + kTableNumbers);
  next += kTableNumbers;
  data.free.assign(next, next + kFree);
  data.poses.assign(all.begin() + head, all.end());
  return data;
}

// Distance |A_0 A_1 ... A_7 0| with A_i = Rz(theta_i) T(a_i, 0, d_i) Rx(alpha_i), for a few poses.
struct Distances {
  const Data* data;
  size_t first, count;

  // For automatic derivatives: the position is moved from the handle back to frame (-1).
  template <typename T>
  bool operator()(const T* deviations, T* residuals) const {
    using std::cos, std::sin, std::sqrt;
    T table[kTableNumbers], cos_alpha[kRows], sin_alpha[kRows];
    for (int i = 0; i < kTableNumbers; ++i) table[i] = T(data->table[i]);
    for (int k = 0; k < kFree; ++k) table[data->free[k]] += deviations[k];
    for (int i = 0; i < kRows; ++i) {
      cos_alpha[i] = cos(table[4 * i + 1]);
      sin_alpha[i] = sin(table[4 * i + 1]);
    }
    for (size_t pose = 0; pose < count; ++pose) {
      const double* q = &data->poses[(first + pose) * kPoseNumbers];
      T x(0.0), y(0.0), z(0.0);
      for (int i = kRows - 1; i >= 0; --i) {
        const T theta = i == 0 ? table[3] : T(table[4 * i + 3] + q[i - 1]);
        const T c = cos(theta), s = sin(theta);
        const T u = x + table[4 * i];
        const T v = cos_alpha[i] * y - sin_alpha[i] * z;
        z = sin_alpha[i] * y + cos_alpha[i] * z + table[4 * i + 2];
        x = c * u - s * v;
        y = s * u + c * v;
      }
      residuals[pose] = (sqrt(x * x + y * y + z * z) - q[kJoints]) / data->sd;
    }
    return true;
  }
};

// The same with derivatives by hand, in reverse: the gradient of the distance is carried from frame
// (-1) to the handle and meets each elementary motion on its way. The derivative of residual i by
// parameter k goes to jacobian[i * row + k * column].
void differentiate(const Distances& some, const double* deviations, double* residuals,
                   double* jacobian, size_t row, size_t column) {
  const Data& data = *some.data;
  double table[kTableNumbers], cos_alpha[kRows], sin_alpha[kRows];
  std::copy(data.table.begin(), data.table.end(), table);
  for (int k = 0; k < kFree; ++k) table[data.free[k]] += deviations[k];
  for (int i = 0; i < kRows; ++i) {
    cos_alpha[i] = std::cos(table[4 * i + 1]);
    sin_alpha[i] = std::sin(table[4 * i + 1]);
  }
  for (size_t pose = 0; pose < some.count; ++pose) {
    const double* q = &data.poses[(some.first + pose) * kPoseNumbers];
    double c[kRows], s[kRows], vy[kRows], vz[kRows], px[kRows], py[kRows], gradient[kTableNumbers];
    double x = 0, y = 0, z = 0;
    for (int i = kRows - 1; i >= 0; --i) {
      const double theta = table[4 * i + 3] + (i == 0 ? 0.0 : q[i - 1]);
      c[i] = std::cos(theta);
      s[i] = std::sin(theta);
      const double u = x + table[4 * i];
      vy[i] = cos_alpha[i] * y - sin_alpha[i] * z;  // after Rx(alpha)
      vz[i] = sin_alpha[i] * y + cos_alpha[i] * z;
      z = vz[i] + table[4 * i + 2];
      px[i] = x = c[i] * u - s[i] * vy[i];  // after Rz(theta)
      py[i] = y = s[i] * u + c[i] * vy[i];
    }
    const double distance = std::sqrt(x * x + y * y + z * z), scale = 1.0 / (distance * data.sd);
    residuals[pose] = (distance - q[kJoints]) / data.sd;
    double gx = scale * x, gy = scale * y, gz = scale * z;
    for (int i = 0; i < kRows; ++i) {
      gradient[4 * i + 3] = gy * px[i] - gx * py[i];
      const double hx = c[i] * gx + s[i] * gy, hy = c[i] * gy - s[i] * gx;
      gradient[4 * i] = hx;
      gradient[4 * i + 1] = gz * vy[i] - hy * vz[i];
      gradient[4 * i + 2] = gz;
      gx = hx;
      gy = cos_alpha[i] * hy + sin_alpha[i] * gz;
      gz = cos_alpha[i] * gz - sin_alpha[i] * hy;
    }
    for (int k = 0; k < kFree; ++k) jacobian[pose * row + k * column] = gradient[data.free[k]];
  }
}

struct Analytic : ceres::CostFunction {
  Distances some;
  explicit Analytic(const Distances& distances) : some(distances) {
    mutable_parameter_block_sizes()->push_back(kFree);
    set_num_residuals(static_cast<int>(some.count));
  }
  bool Evaluate(double const* const* deviations, double* residuals, double** jacobians) const override {
    if (!jacobians || !jacobians[0]) return some(deviations[0], residuals);
    differentiate(some, deviations[0], residuals, jacobians[0], kFree, 1);
    return true;
  }
};

// For ceres::TinySolver, which keeps everything in one dense matrix, column by column.
struct Tiny {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kFree };
  Distances all;
  int NumResiduals() const { return static_cast<int>(all.count); }
  bool operator()(const double* deviations, double* residuals, double* jacobian) const {
    if (!jacobian) return all(deviations, residuals);
    differentiate(all, deviations, residuals, jacobian, 1, all.count);
    return true;
  }
};

struct Solved {
  double cost;  // sum of squares
  int iterations;
  double construction_s, solve_s;
};

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// Levenberg-Marquardt with a first step that is all but Gauss-Newton's: with the default radius of
// 1e4 two steps more are needed. The function tolerance decides alone.
constexpr double kRadius = 1e12;

Solved solve(const Data& data, bool automatic, const std::string& solver, int threads, double tolerance) {
  const auto start = Clock::now();
  double deviations[kFree] = {};
  ceres::Problem problem;
  for (size_t first = 0; first < data.size(); first += kBlock) {
    const Distances some{&data, first, std::min(kBlock, data.size() - first)};
    const int count = static_cast<int>(some.count);
    ceres::CostFunction* cost = nullptr;
    if (automatic) {
      cost = new ceres::AutoDiffCostFunction<Distances, ceres::DYNAMIC, kFree>(new Distances(some), count);
    } else {
      cost = new Analytic(some);
    }
    problem.AddResidualBlock(cost, nullptr, deviations);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = solver == "qr" ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = threads;
  options.initial_trust_region_radius = kRadius;
  options.function_tolerance = tolerance;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  const auto constructed = Clock::now();
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const auto end = Clock::now();
  // Ceres' cost is half the sum of squares; its first "successful step" is the start.
  return {2.0 * summary.final_cost, summary.num_successful_steps - 1, seconds(start, constructed),
          seconds(constructed, end)};
}

Solved solve_tiny(const Data& data, double tolerance) {
  const auto start = Clock::now();
  const Tiny problem{{&data, 0, data.size()}};
  ceres::TinySolver<Tiny>::Parameters deviations = ceres::TinySolver<Tiny>::Parameters::Zero();
  static ceres::TinySolver<Tiny> solver;  // keeps its memory
  solver.options.initial_trust_region_radius = kRadius;
  // Its tolerance is absolute; near the solution the cost is about half the number of poses.
  solver.options.function_tolerance = tolerance * static_cast<double>(data.size());
  solver.options.gradient_tolerance = 0.0;
  solver.options.parameter_tolerance = 0.0;
  const auto constructed = Clock::now();
  const auto& summary = solver.Solve(problem, &deviations);
  const auto end = Clock::now();
  return {2.0 * summary.final_cost, summary.iterations, seconds(start, constructed), seconds(constructed, end)};
}

void print(const char* name, const std::vector<double>& numbers) {
  const char* before = "[";
  std::printf(",\"%s\":", name);
  for (double number : numbers) {
    std::printf("%s%.9g", before, number);
    before = ",";
  }
  std::printf("]");
}

int main(int count, char** paths) {
  std::vector<Data> files;
  for (int i = 1; i < count; ++i) files.push_back(read(paths[i]));
  std::printf("{\"version\":\"Ceres %s\"}\n", CERES_VERSION_STRING);
  std::fflush(stdout);
  size_t file;
  std::string derivatives, solver;
  double tolerance;
  int threads, repeats;
  while (std::cin >> file >> derivatives >> solver >> threads >> tolerance >> repeats) {
    const Data& data = files.at(file);
    Solved solved{};
    std::vector<double> construction_s, solve_s;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      solved = solver == "tiny" ? solve_tiny(data, tolerance)
                                : solve(data, derivatives == "automatic", solver, threads, tolerance);
      construction_s.push_back(solved.construction_s);
      solve_s.push_back(solved.solve_s);
    }
    std::printf("{\"cost\":%.17g,\"iterations\":%d", solved.cost, solved.iterations);
    print("construction_s", construction_s);
    print("solve_s", solve_s);
    std::printf("}\n");
    std::fflush(stdout);
  }
}
