/*@PROVENANCE@*/
#ifndef HAPTICAL_MODEL_H
#define HAPTICAL_MODEL_H

#include <math.h>
#include <stddef.h>

/* SI units. Joint values are in rad, for a prismatic joint in m. Vectors are in frame (-1). */

#define HAPTICAL_JOINTS /*@JOINTS@*/
#define HAPTICAL_ROWS /*@ROWS@*/ /* rows that move: some may follow another one's joint */
#define HAPTICAL_TERMS /*@TERMS@*/
#define HAPTICAL_LARGEST_VALUE 1e6
#define HAPTICAL_SINGULAR_MARGIN 1e-9

/* What haptical_step, haptical_check_limits and the torques return; haptical_state.joint names the joint, from 1. */
enum haptical_status {
    HAPTICAL_OK = 0,
    HAPTICAL_NOT_FINITE = 1,     /* a reading, a force or a moment is not finite */
    HAPTICAL_OUT_OF_RANGE = 2,   /* a reading is not between lower and upper */
    HAPTICAL_OPEN_LOOP = 3,      /* a parallelogram is open or stretched */
    HAPTICAL_VALUE_TOO_LARGE = 4, /* a corrected joint value or a torque is too large */
    HAPTICAL_BEYOND_LIMIT = 5    /* a reading is beyond the joint limits of the device */
};

enum haptical_transmission {
    HAPTICAL_EXACT = 0,
    HAPTICAL_CAPSTAN = 1,
    HAPTICAL_PARALLELOGRAM = 2,
    HAPTICAL_POLYNOMIAL = 3
};

/* One row that moves: what is left of the chain up to the next one, worked out by haptical-kinematics
 * (Preparation). It turns about z by offset_rad and, if it is a turn, its variable; or slides along z by
 * its variable; then slides along x and y, and turns about x. */
typedef struct haptical_row {
    double offset_rad;
    double x_m, y_m;
    double twist_sine, twist_cosine;
    int prismatic;
    int joint;         /* from 0 */
    double multiplier; /* row variable per joint variable */
} haptical_row;

/* One joint. Drums: centre at home over the denominator, and its angle there. */
typedef struct haptical_joint {
    int transmission;
    double lower, upper;
    double offset, ratio, ratio_slope;
    double output_x, output_y, output_home_rad;
    double input_x, input_y, input_home_rad;
    double lengths[4]; /* over the longest */
    double loop_home_rad;
    double coefficients[HAPTICAL_TERMS];
} haptical_joint;

/* A device at one set of readings. */
typedef struct haptical_state {
    int joint;                                 /* the joint of an error, from 1; 0: none */
    double outputs[HAPTICAL_JOINTS];           /* corrected joint values, from home */
    double output_slopes[HAPTICAL_JOINTS];     /* d(output)/d(reading) */
    double position_m[3];                      /* origin of the handle's frame */
    double rotation[3][3];                     /* its axes are the columns */
    double jacobian_linear[HAPTICAL_JOINTS][3];  /* of the outputs */
    double jacobian_angular[HAPTICAL_JOINTS][3];
} haptical_state;

/*@DATA@*/
/* sin and cos turn two axes in their plane, the first towards the second. */
static inline void haptical_turn(double first[3], double second[3], double sine, double cosine)
{
    for (int i = 0; i < 3; ++i) {
        const double turned = first[i] * cosine + second[i] * sine;
        second[i] = second[i] * cosine - first[i] * sine;
        first[i] = turned;
    }
}

static inline void haptical_slide(double origin[3], const double axis[3], double length_m)
{
    for (int i = 0; i < 3; ++i) {
        origin[i] += axis[i] * length_m;
    }
}

/* The formulas below are those of haptical-transmission (CapstanTerms, FourBar, chebyshev) and of
 * haptical-kinematics (PreparedChain), in C because a controller's compiler knows no Rust; a test of the
 * command compares them with the Rust on thousands of readings. */

/* An eccentric drum's angle from home and its slope, eq. (1). */
static inline double haptical_drum(double x, double y, double home_rad, double phi_rad, double *slope)
{
    const double sine = sin(phi_rad), cosine = cos(phi_rad);
    const double n = x * sine + y * cosine;
    const double q = x * cosine - y * sine;
    const double d = 1.0 - q;
    *slope = (q * d - n * n) / (n * n + d * d);
    return atan2(n, d) - home_rad;
}

static inline double haptical_capstan(const haptical_joint *joint, double reading, double *slope)
{
    double output_slope, input_slope;
    const double output = haptical_drum(joint->output_x, joint->output_y, joint->output_home_rad,
                                        reading, &output_slope);
    const double input = haptical_drum(joint->input_x, joint->input_y, joint->input_home_rad,
                                       joint->ratio * reading, &input_slope);
    *slope = joint->ratio_slope + output_slope + joint->ratio * input_slope;
    return joint->offset + joint->ratio_slope * reading + output + input;
}

/* Error of a four-bar loop at its input angle, eq. (2) corrected; 0 is returned where it is open. */
static inline int haptical_loop(const haptical_joint *joint, double input_rad, double *error,
                                double *slope)
{
    const double l1 = joint->lengths[0], l2 = joint->lengths[1];
    const double l3 = joint->lengths[2], l4 = joint->lengths[3];
    const double sine = sin(input_rad), cosine = cos(input_rad);
    if (!(fabs(input_rad) < 1.5707963267948966) || cosine <= HAPTICAL_SINGULAR_MARGIN) {
        return 0;
    }
    const double u = l1 - l2 * sine, v = l2 * cosine;
    const double s_squared = u * u + v * v, s = sqrt(s_squared);
    const double perimeter = l3 + l4 + s, margin = HAPTICAL_SINGULAR_MARGIN * perimeter;
    const double first = l3 + l4 - s, second = l3 + (s - l4), third = l4 + (s - l3);
    if (!(first > margin && second > margin && third > margin)) {
        return 0;
    }
    const double k = sqrt(perimeter * first) * sqrt(second * third);
    const double difference = (l4 - l3) * (l4 + l3);
    const double u_rate = -v, v_rate = -l2 * sine;
    const double s_rate = (u * u_rate + v * v_rate) / s;
    *error = atan2(v, u) + atan2(k, s_squared + difference) - joint->loop_home_rad - input_rad;
    *slope = (u * v_rate - v * u_rate) / s_squared + (difference - s_squared) / (s * k) * s_rate - 1.0;
    return 1;
}

/* A Chebyshev series over lower to upper, by Clenshaw's recurrence. */
static inline double haptical_series(const haptical_joint *joint, double reading, double *slope)
{
    const double width = joint->upper - joint->lower;
    const double x = (reading - joint->lower) / width - (joint->upper - reading) / width;
    double b1 = 0.0, b2 = 0.0, slope1 = 0.0, slope2 = 0.0;
    for (int k = HAPTICAL_TERMS - 1; k > 0; --k) {
        const double slope0 = 2.0 * (b1 + x * slope1) - slope2;
        const double b0 = joint->coefficients[k] + 2.0 * x * b1 - b2;
        slope2 = slope1;
        slope1 = slope0;
        b2 = b1;
        b1 = b0;
    }
    *slope = (b1 + x * slope1 - slope2) * 2.0 / width;
    return joint->coefficients[0] + x * b1 - b2;
}

/* Corrected joint value and its slope. */
static inline int haptical_output(const haptical_joint *joint, double reading, double *output,
                                  double *slope)
{
    double error = 0.0, error_slope = 0.0;
    if (!isfinite(reading)) {
        return HAPTICAL_NOT_FINITE;
    }
    if (reading < joint->lower || reading > joint->upper) {
        return HAPTICAL_OUT_OF_RANGE;
    }
    if (joint->transmission == HAPTICAL_CAPSTAN) {
        error = haptical_capstan(joint, reading, &error_slope);
    } else if (joint->transmission == HAPTICAL_PARALLELOGRAM) {
        double loop, loop_slope;
        error = haptical_capstan(joint, reading, &error_slope);
        if (!haptical_loop(joint, reading + error, &loop, &loop_slope)) {
            return HAPTICAL_OPEN_LOOP;
        }
        error += loop;
        error_slope += loop_slope * (1.0 + error_slope);
    } else if (joint->transmission == HAPTICAL_POLYNOMIAL) {
        error = haptical_series(joint, reading, &error_slope);
    }
    *output = reading + error;
    *slope = 1.0 + error_slope;
    return fabs(*output) <= HAPTICAL_LARGEST_VALUE ? HAPTICAL_OK : HAPTICAL_VALUE_TOO_LARGE;
}

/* Whether all readings lie within the joint limits of the device; `joint` is the first that does not, from 1,
 * or 0. haptical_step does not ask: beyond a limit the model may hold, and a controller needs the pose there
 * to come back. */
static inline int haptical_check_limits(const double readings[HAPTICAL_JOINTS], int *joint)
{
    for (int index = 0; index < HAPTICAL_JOINTS; ++index) {
        *joint = index + 1;
        if (!isfinite(readings[index])) {
            return HAPTICAL_NOT_FINITE;
        }
        if (readings[index] < haptical_limits[index][0] || readings[index] > haptical_limits[index][1]) {
            return HAPTICAL_BEYOND_LIMIT;
        }
    }
    *joint = 0;
    return HAPTICAL_OK;
}

/* Where the device stands at `readings`: motor-side encoder angles over the nominal ratios. On an
 * error only `joint` of the state is of use. */
static inline int haptical_step(const double readings[HAPTICAL_JOINTS], haptical_state *state)
{
    double origin[3], x[3], y[3], z[3];
    double points[HAPTICAL_ROWS + 1][3], axes[HAPTICAL_ROWS + 1][3]; /* C knows no empty arrays */
    state->joint = 0;
    for (int index = 0; index < HAPTICAL_JOINTS; ++index) {
        const int status = haptical_output(&haptical_joints[index], readings[index],
                                           &state->outputs[index], &state->output_slopes[index]);
        if (status != HAPTICAL_OK) {
            state->joint = index + 1;
            return status;
        }
        for (int i = 0; i < 3; ++i) {
            state->jacobian_linear[index][i] = 0.0;
            state->jacobian_angular[index][i] = 0.0;
        }
    }
    for (int i = 0; i < 3; ++i) {
        origin[i] = haptical_start[0][i];
        x[i] = haptical_start[1][i];
        y[i] = haptical_start[2][i];
        z[i] = haptical_start[3][i];
    }
    for (int row = 0; row < HAPTICAL_ROWS; ++row) {
        const haptical_row *constants = &haptical_rows[row];
        const double variable = constants->multiplier * state->outputs[constants->joint];
        double angle_rad = constants->offset_rad;
        if (!(fabs(variable) <= HAPTICAL_LARGEST_VALUE)) {
            state->joint = constants->joint + 1;
            return HAPTICAL_VALUE_TOO_LARGE;
        }
        for (int i = 0; i < 3; ++i) {
            points[row][i] = origin[i];
            axes[row][i] = z[i];
        }
        if (constants->prismatic) {
            haptical_slide(origin, z, variable);
        } else {
            angle_rad += variable;
        }
        haptical_turn(x, y, sin(angle_rad), cos(angle_rad));
        haptical_slide(origin, x, constants->x_m);
        haptical_slide(origin, y, constants->y_m);
        haptical_turn(y, z, constants->twist_sine, constants->twist_cosine);
    }
    haptical_turn(x, y, haptical_end[0], haptical_end[1]);
    for (int i = 0; i < 3; ++i) {
        state->position_m[i] = origin[i];
        state->rotation[i][0] = x[i];
        state->rotation[i][1] = y[i];
        state->rotation[i][2] = z[i];
    }
    for (int row = 0; row < HAPTICAL_ROWS; ++row) {
        const haptical_row *constants = &haptical_rows[row];
        double *linear = state->jacobian_linear[constants->joint];
        double *angular = state->jacobian_angular[constants->joint];
        const double *axis = axes[row];
        double arm[3];
        for (int i = 0; i < 3; ++i) {
            arm[i] = origin[i] - points[row][i];
            if (constants->prismatic) {
                linear[i] += constants->multiplier * axis[i];
            } else {
                angular[i] += constants->multiplier * axis[i];
            }
        }
        if (!constants->prismatic) {
            linear[0] += constants->multiplier * (axis[1] * arm[2] - axis[2] * arm[1]);
            linear[1] += constants->multiplier * (axis[2] * arm[0] - axis[0] * arm[2]);
            linear[2] += constants->multiplier * (axis[0] * arm[1] - axis[1] * arm[0]);
        }
    }
    return HAPTICAL_OK;
}

/* Torques (N for a prismatic joint) that exert `force_n` at the handle's origin and `moment_nm` about
 * it, at the joint axes, or with `factors` of the joints: pass output_slopes for the torques that the
 * readings see, NULL for the joint axes. */
static inline int haptical_torques(const haptical_state *state, const double force_n[3],
                                   const double moment_nm[3], const double *factors,
                                   double torques_nm[HAPTICAL_JOINTS])
{
    for (int i = 0; i < 3; ++i) {
        if (!isfinite(force_n[i]) || !isfinite(moment_nm[i])) {
            return HAPTICAL_NOT_FINITE;
        }
    }
    for (int index = 0; index < HAPTICAL_JOINTS; ++index) {
        double sum = 0.0;
        for (int i = 0; i < 3; ++i) {
            sum += state->jacobian_linear[index][i] * force_n[i];
            sum += state->jacobian_angular[index][i] * moment_nm[i];
        }
        sum *= factors == NULL ? 1.0 : factors[index];
        if (!isfinite(sum)) {
            return HAPTICAL_VALUE_TOO_LARGE;
        }
        torques_nm[index] = sum;
    }
    return HAPTICAL_OK;
}

#endif
