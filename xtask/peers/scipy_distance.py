"""The 28-parameter distance identification by SciPy: a peer of `cargo xtask bench-peers`.

usage: scipy_distance.py FILE...   (formats: bench_peers/files.rs, bench_peers/protocol.rs)
A request is one line `FILE DERIVATIVES METHOD THREADS FUNCTION_TOLERANCE REPEATS`, FILE counted from
0; the answer is one line of JSON. Files are read before the first request, never timed.
"""

import json
import sys
import time

import numpy
import scipy
from scipy.optimize import least_squares

JOINTS = 7
ROWS = JOINTS + 1
FREE = 28
# The function tolerance decides alone; MINPACK wants the others above the rounding.
SMALLEST = 3e-16


class Distances:
    """Distance |A_0 A_1 ... A_7 0| with A_i = Rz(theta_i) T(a_i, 0, d_i) Rx(alpha_i), all poses at once."""

    def __init__(self, path):
        numbers = numpy.fromfile(path, dtype="<f8")
        poses, self.sd = int(numbers[0]), numbers[1]
        table, free, rest = numpy.split(numbers[2:], [4 * ROWS, 4 * ROWS + FREE])
        self.table = table
        self.free = free.astype(int)
        rest = rest.reshape(poses, JOINTS + 1)
        self.joints = numpy.vstack([numpy.zeros(poses), rest[:, :JOINTS].T])
        self.measured_m = rest[:, JOINTS].copy()

    def forward(self, values):
        """Position of the handle, and what it was on its way back to frame (-1)."""
        table = self.table.copy()
        table[self.free] = values
        a, alpha, d, theta = table.reshape(ROWS, 4).T
        cos, sin = numpy.cos(self.joints + theta[:, None]), numpy.sin(self.joints + theta[:, None])
        x = y = z = numpy.zeros(len(self.measured_m))
        way = []
        for i in reversed(range(ROWS)):
            ca, sa = numpy.cos(alpha[i]), numpy.sin(alpha[i])
            vy, vz = ca * y - sa * z, sa * y + ca * z  # after Rx(alpha)
            u, z = x + a[i], vz + d[i]
            x, y = cos[i] * u - sin[i] * vy, sin[i] * u + cos[i] * vy  # after Rz(theta)
            way.append((ca, sa, vy, vz, x, y))
        return x, y, z, cos, sin, way[::-1]

    def residuals(self, values):
        x, y, z, *_ = self.forward(values)
        return (numpy.sqrt(x * x + y * y + z * z) - self.measured_m) / self.sd

    def derivatives(self, values):
        """In reverse: the gradient of the distance is carried from frame (-1) to the handle."""
        x, y, z, cos, sin, way = self.forward(values)
        scale = 1.0 / (numpy.sqrt(x * x + y * y + z * z) * self.sd)
        gx, gy, gz = scale * x, scale * y, scale * z
        gradient = numpy.empty((4 * ROWS, len(scale)))
        for i, (ca, sa, vy, vz, px, py) in enumerate(way):
            hx, hy = cos[i] * gx + sin[i] * gy, cos[i] * gy - sin[i] * gx
            gradient[4 * i] = hx
            gradient[4 * i + 1] = gz * vy - hy * vz
            gradient[4 * i + 2] = gz
            gradient[4 * i + 3] = gy * px - gx * py
            gx, gy, gz = hx, ca * hy + sa * gz, ca * gz - sa * hy
        return gradient[self.free].T


def main():
    files = [Distances(path) for path in sys.argv[1:]]
    print(json.dumps({"version": f"SciPy {scipy.__version__}, NumPy {numpy.__version__}"}), flush=True)
    for line in sys.stdin:
        file, derivatives, method, _threads, tolerance, repeats = line.split()
        problem = files[int(file)]
        solve_s = []
        for _ in range(int(repeats)):
            start = time.perf_counter()
            solved = least_squares(
                problem.residuals,
                # Values, not deviations: the first trust region is as large as the start.
                problem.table[problem.free],
                jac=problem.derivatives if derivatives == "analytic" else "2-point",
                method=method,
                x_scale="jac",
                ftol=float(tolerance),
                xtol=SMALLEST,
                gtol=SMALLEST,
            )
            solve_s.append(time.perf_counter() - start)
        answer = {
            "cost": 2.0 * solved.cost,  # SciPy's is half the sum of squares
            "iterations": int(solved.njev or solved.nfev),
            "construction_s": [],
            "solve_s": solve_s,
        }
        print(json.dumps(answer), flush=True)


main()
