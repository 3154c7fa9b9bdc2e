/* The device with its effects. The formulas are those of haptical-runtime (CompensatedModel, docs/equations.md,
 * Effects in a control loop); its tests compare the two. */

#define HAPTICAL_EFFECTS /*@EFFECTS@*/
#define HAPTICAL_LARGEST_INPUT 1e12
/* What haptical_forward and the inverses return beside the values of haptical_status. */
#define HAPTICAL_BAD_INPUT 6   /* an input beside the readings is not finite or above 1e12 in size */
#define HAPTICAL_DISPLACED 7   /* the effects displace the handle by more than 1e6 */
#define HAPTICAL_NOT_REACHED 8 /* no reading gives a wanted joint value */
#define HAPTICAL_POSE_NOT_REACHED 9 /* no posture near the present one has a wanted pose */
#define HAPTICAL_NOT_A_POSE 10 /* a wanted position is above 1e6 m in size, or a wanted rotation is none to 1e-6 */

/* Kinds, and their numbers `n`. */
enum haptical_kind {
    HAPTICAL_NO_EFFECT,          /* fills the list of a device without effects */
    HAPTICAL_CAPSTAN_COMPLIANCE, /* rad/Nm */
    HAPTICAL_JOINT_COMPLIANCE,   /* rad/Nm */
    HAPTICAL_PLAY,               /* half width of the play, error at its ends */
    HAPTICAL_DAHL,               /* transition, amplitude */
    HAPTICAL_CREEP,              /* per Nm */
    HAPTICAL_LAG,                /* delay */
    HAPTICAL_LATENCY,            /* delay, of all joints */
    HAPTICAL_HARMONIC,           /* periods, cosine, sine */
    HAPTICAL_POWERS,             /* quadratic, cubic */
    HAPTICAL_COUPLING,           /* gain */
    HAPTICAL_DRIFT,              /* per s */
    HAPTICAL_SETTLING,           /* end, time constant */
    HAPTICAL_WARM,               /* per degC, reference */
    HAPTICAL_CURVE_OVER_ANGLE,   /* ends, as those below */
    HAPTICAL_CURVE_OVER_TORQUE,
    HAPTICAL_CURVE_OVER_TEMPERATURE,
    HAPTICAL_CURVE_OVER_TIME,
    HAPTICAL_LATERAL,            /* rad/Nm */
    HAPTICAL_BASE,               /* rad/Nm, base */
    HAPTICAL_TOOL,               /* m/N */
    HAPTICAL_WOBBLE,             /* order, two cosines, two sines */
    HAPTICAL_GROWTH,             /* per degC, reference, base */
    HAPTICAL_SHIFT,              /* in the handle's axes */
    HAPTICAL_WEIGHT,             /* force */
    HAPTICAL_TORQUE_GAIN,        /* gain */
    HAPTICAL_FRICTION_OF_TRAVEL, /* Coulomb, viscous, Stribeck, Stribeck's rate, transition */
    HAPTICAL_FRICTION_OF_RATE,   /* the same, rate */
    HAPTICAL_COGGING,            /* periods, cosine, sine */
    HAPTICAL_PAYLOAD,            /* mass, gravity */
    HAPTICAL_FORCE_BIAS,         /* of the axes, as those below */
    HAPTICAL_FORCE_WARM_BIAS,    /* per degC, reference */
    HAPTICAL_FORCE_GAIN,
    HAPTICAL_FORCE_CROSSTALK,    /* y and z on x, x and z on y, x and y on z */
    HAPTICAL_FORCE_HYSTERESIS    /* sizes, transition */
};

typedef struct haptical_effect {
    int kind;
    int joint, from; /* from 0 */
    int row;         /* whose frames carry `local_m`: in front of it, of a weight behind it */
    int joint_before; /* which moves the row before; -1: none */
    double n[6];
    double local_m[3];
    int first, count; /* coefficients of a curve */
} haptical_effect;

/* What is known at one instant; what no effect of the device needs stays 0. */
typedef struct haptical_inputs {
    double readings[HAPTICAL_JOINTS];
    double torque_nm[HAPTICAL_JOINTS];     /* of the drives, at the joints */
    double velocity[HAPTICAL_JOINTS];      /* of the readings */
    double acceleration[HAPTICAL_JOINTS];
    double force_n[3];                     /* of the hand, as its sensor reads it, in the handle's axes */
    double handle_acceleration_mps2[3];    /* in frame (-1) */
    double time_s;                         /* since the start */
    double temperature_degc;
} haptical_inputs;

/* What effects remember from step to step: reset it before the first step and after each homing. */
typedef struct haptical_effect_state {
    int has_started[HAPTICAL_EFFECTS];
    double last[HAPTICAL_EFFECTS][3], value[HAPTICAL_EFFECTS][3];
} haptical_effect_state;

/* The device at one instant, effects included. */
typedef struct haptical_compensated {
    haptical_state state; /* outputs are the true joint values, the pose is that of the displaced handle */
    double links[HAPTICAL_JOINTS];
    double hand_force_n[3]; /* without the errors of its sensor, in frame (-1) */
    double added_nm[HAPTICAL_JOINTS], gain[HAPTICAL_JOINTS]; /* of the drives' torques */
} haptical_compensated;

/* A pose of the handle. */
typedef struct haptical_pose {
    double position_m[3];
    double rotation[3][3]; /* its axes are the columns */
} haptical_pose;

/* What haptical_inverse_pose finds. */
typedef struct haptical_found {
    double readings[HAPTICAL_JOINTS]; /* what motors must be told */
    double outputs[HAPTICAL_JOINTS];  /* joint values */
    double left_m, left_rad;          /* what is left to the pose: below 1e-10 where it was reached */
    int joint;                        /* the joint of an error, from 1; 0: none */
} haptical_found;

/* Of all curves, one behind the other. */
static const double haptical_coefficients[] = {
/*@COEFFICIENTS@*/
};

/*@EFFECT_DATA@*/
static inline void haptical_reset_state(haptical_effect_state *state)
{
    const haptical_effect_state none = {{0}, {{0.0}}, {{0.0}}};
    *state = none;
}

static inline double haptical_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* sum += a x b */
static inline void haptical_add_cross(double sum[3], const double a[3], const double b[3])
{
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
}

/* Output of a play less its input, over the half width (Prandtl). */
static inline double haptical_step_play(haptical_effect_state *state, int effect, double half_width, double travel)
{
    double output = state->has_started[effect] ? state->value[effect][0] : travel;
    half_width = fmax(half_width, 1e-12);
    output = fmin(fmax(output, travel - half_width), travel + half_width);
    state->has_started[effect] = 1;
    state->value[effect][0] = output;
    return (output - travel) / half_width;
}

/* Dahl's state after a travel. */
static inline double haptical_step_dahl(haptical_effect_state *state, int effect, int axis, double transition,
                                        double travel)
{
    double *value = &state->value[effect][axis];
    const double step = state->has_started[effect] ? travel - state->last[effect][axis] : 0.0;
    state->last[effect][axis] = travel;
    if (step != 0.0) {
        const double side = step > 0.0 ? 1.0 : -1.0;
        const double x = fabs(step) / fmax(transition, 1e-12);
        double left = 0.0;
        if (x < 0.1) {
            left = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x / 6.0)));
        } else if (x <= 30.0) {
            left = exp(-x);
        }
        *value = side + (*value - side) * left;
    }
    return *value;
}

static inline double haptical_delayed(const haptical_inputs *inputs, int joint, double delay_s)
{
    return delay_s * (0.5 * delay_s * inputs->acceleration[joint] - inputs->velocity[joint]);
}

/* A curve of uniform cubic B-splines, and its slope: haptical-transmission, spline. */
static inline double haptical_curve(const haptical_effect *effect, double place, double *slope)
{
    const double from = effect->n[0], to = effect->n[1];
    const int intervals = effect->count - 3;
    const double width = (to - from) / intervals;
    const double along = (fmin(fmax(place, from), to) - from) / width;
    const int interval = along < intervals - 1 ? (int)along : intervals - 1;
    const double u = along - interval, v = 1.0 - u;
    const double *c = haptical_coefficients + effect->first + interval;
    *slope = 0.0;
    if (from <= place && place <= to) {
        *slope = (-c[0] * v * v + c[1] * ((3.0 * u - 4.0) * u) + c[2] * ((2.0 - 3.0 * u) * u + 1.0) + c[3] * u * u)
                 * (0.5 / width);
    }
    return (c[0] * (v * v * v) + c[1] * ((3.0 * u - 6.0) * u * u + 4.0)
            + c[2] * (((3.0 - 3.0 * u) * u + 3.0) * u + 1.0) + c[3] * (u * u * u))
           / 6.0;
}

/* Error of one joint's angle by one effect, and its slope; 0 by one of another kind. `output` is the joint's value by its
   transmission. */
static inline int haptical_drive_error(int index, int joint, double output, const haptical_inputs *inputs,
                                       haptical_effect_state *state, double *error, double *slope)
{
    const haptical_effect *effect = &haptical_effects[index];
    const double *n = effect->n;
    const double q = inputs->readings[joint];
    *error = 0.0;
    *slope = 0.0;
    if (effect->kind == HAPTICAL_LATENCY) {
        *error = haptical_delayed(inputs, joint, -n[0]);
        return HAPTICAL_OK;
    }
    if (effect->joint != joint) {
        return HAPTICAL_OK;
    }
    switch (effect->kind) {
    case HAPTICAL_CAPSTAN_COMPLIANCE:
        *error = -n[0] * inputs->torque_nm[joint];
        break;
    case HAPTICAL_PLAY:
        *error = n[1] * haptical_step_play(state, index, n[0], inputs->readings[effect->from]);
        break;
    case HAPTICAL_DAHL:
        *error = n[1] * haptical_step_dahl(state, index, 0, n[0], output);
        state->has_started[index] = 1;
        break;
    case HAPTICAL_CREEP:
        if (state->has_started[index]) {
            const double mean = 0.5 * (inputs->torque_nm[joint] + state->last[index][1]);
            state->value[index][0] -= mean * fabs(q - state->last[index][0]);
        }
        state->has_started[index] = 1;
        state->last[index][0] = q;
        state->last[index][1] = inputs->torque_nm[joint];
        *error = n[0] * state->value[index][0];
        break;
    case HAPTICAL_LAG:
        *error = haptical_delayed(inputs, joint, n[0]);
        break;
    case HAPTICAL_HARMONIC: {
        const double sine = sin(n[0] * q), cosine = cos(n[0] * q);
        if (!(fabs(n[0] * q) <= HAPTICAL_LARGEST_VALUE)) {
            return HAPTICAL_OUT_OF_RANGE;
        }
        *error = n[1] * cosine + n[2] * sine;
        *slope = n[0] * (n[2] * cosine - n[1] * sine);
        break;
    }
    case HAPTICAL_POWERS:
        *error = n[0] * (q * q) + n[1] * (q * q * q);
        *slope = (2.0 * n[0] + 3.0 * n[1] * q) * q;
        break;
    case HAPTICAL_COUPLING:
        *error = n[0] * inputs->readings[effect->from];
        *slope = effect->from == joint ? n[0] : 0.0;
        break;
    case HAPTICAL_DRIFT:
        *error = n[0] * inputs->time_s;
        break;
    case HAPTICAL_SETTLING:
        *error = n[0] * (1.0 - exp(-inputs->time_s / n[1]));
        break;
    case HAPTICAL_WARM:
        *error = n[0] * (inputs->temperature_degc - n[1]);
        break;
    case HAPTICAL_CURVE_OVER_ANGLE:
        *error = haptical_curve(effect, q, slope);
        break;
    case HAPTICAL_CURVE_OVER_TORQUE:
        *error = haptical_curve(effect, inputs->torque_nm[joint], slope);
        *slope = 0.0;
        break;
    case HAPTICAL_CURVE_OVER_TEMPERATURE:
        *error = haptical_curve(effect, inputs->temperature_degc, slope);
        *slope = 0.0;
        break;
    case HAPTICAL_CURVE_OVER_TIME:
        *error = haptical_curve(effect, inputs->time_s, slope);
        *slope = 0.0;
        break;
    default:
        break;
    }
    return HAPTICAL_OK;
}

/* What the force sensor reads too much by one effect. */
static inline void haptical_sensor_error(int index, const haptical_inputs *inputs, haptical_effect_state *state,
                                         double error_n[3])
{
    const haptical_effect *effect = &haptical_effects[index];
    const double *n = effect->n, *read_n = inputs->force_n;
    for (int i = 0; i < 3; ++i) {
        error_n[i] = 0.0;
        switch (effect->kind) {
        case HAPTICAL_FORCE_BIAS:
            error_n[i] = n[i];
            break;
        case HAPTICAL_FORCE_WARM_BIAS:
            error_n[i] = n[i] * (inputs->temperature_degc - n[3]);
            break;
        case HAPTICAL_FORCE_GAIN:
            error_n[i] = read_n[i] * (n[i] / (1.0 + n[i]));
            break;
        case HAPTICAL_FORCE_CROSSTALK:
            error_n[i] = n[2 * i] * read_n[i == 0 ? 1 : 0] + n[2 * i + 1] * read_n[i == 2 ? 1 : 2];
            break;
        case HAPTICAL_FORCE_HYSTERESIS:
            error_n[i] = n[i] * haptical_step_dahl(state, index, i, n[3], read_n[i]);
            break;
        default:
            break;
        }
    }
    if (effect->kind == HAPTICAL_FORCE_HYSTERESIS) {
        state->has_started[index] = 1;
    }
}

static inline int haptical_is_input(const double *values, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(fabs(values[i]) <= HAPTICAL_LARGEST_INPUT)) {
            return 0;
        }
    }
    return 1;
}

static inline int haptical_check_inputs(const haptical_inputs *inputs)
{
    return haptical_is_input(inputs->torque_nm, HAPTICAL_JOINTS) && haptical_is_input(inputs->velocity, HAPTICAL_JOINTS)
                   && haptical_is_input(inputs->acceleration, HAPTICAL_JOINTS) && haptical_is_input(inputs->force_n, 3)
                   && haptical_is_input(inputs->handle_acceleration_mps2, 3) && haptical_is_input(&inputs->time_s, 1)
                   && haptical_is_input(&inputs->temperature_degc, 1)
               ? HAPTICAL_OK
               : HAPTICAL_BAD_INPUT;
}

/* Frames in front of the rows and behind them: origin, x, y, z. */
typedef double haptical_frame[4][3];

/* Pose and Jacobian of the link angles, with the frames. */
static inline int haptical_walk(const double links[HAPTICAL_JOINTS], haptical_state *state,
                                haptical_frame frames[HAPTICAL_ROWS + 1])
{
    double *origin = frames[0][0];
    haptical_frame end;
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        for (int i = 0; i < 3; ++i) {
            state->jacobian_linear[joint][i] = 0.0;
            state->jacobian_angular[joint][i] = 0.0;
        }
    }
    for (int axis = 0; axis < 4; ++axis) {
        for (int i = 0; i < 3; ++i) {
            frames[0][axis][i] = haptical_start[axis][i];
        }
    }
    for (int row = 0; row < HAPTICAL_ROWS; ++row) {
        const haptical_row *constants = &haptical_rows[row];
        const double variable = constants->multiplier * links[constants->joint];
        double angle_rad = constants->offset_rad;
        double(*frame)[3] = frames[row + 1];
        if (!(fabs(variable) <= HAPTICAL_LARGEST_VALUE)) {
            state->joint = constants->joint + 1;
            return HAPTICAL_VALUE_TOO_LARGE;
        }
        for (int axis = 0; axis < 4; ++axis) {
            for (int i = 0; i < 3; ++i) {
                frame[axis][i] = frames[row][axis][i];
            }
        }
        if (constants->prismatic) {
            haptical_slide(frame[0], frame[3], variable);
        } else {
            angle_rad += variable;
        }
        haptical_turn(frame[1], frame[2], sin(angle_rad), cos(angle_rad));
        haptical_slide(frame[0], frame[1], constants->x_m);
        haptical_slide(frame[0], frame[2], constants->y_m);
        haptical_turn(frame[2], frame[3], constants->twist_sine, constants->twist_cosine);
    }
    for (int axis = 0; axis < 4; ++axis) {
        for (int i = 0; i < 3; ++i) {
            end[axis][i] = frames[HAPTICAL_ROWS][axis][i];
        }
    }
    haptical_turn(end[1], end[2], haptical_end[0], haptical_end[1]);
    origin = end[0];
    for (int i = 0; i < 3; ++i) {
        state->position_m[i] = origin[i];
        for (int axis = 0; axis < 3; ++axis) {
            state->rotation[i][axis] = end[axis + 1][i];
        }
    }
    for (int row = 0; row < HAPTICAL_ROWS; ++row) {
        const haptical_row *constants = &haptical_rows[row];
        double *linear = state->jacobian_linear[constants->joint];
        double *angular = state->jacobian_angular[constants->joint];
        double axis[3], arm[3];
        for (int i = 0; i < 3; ++i) {
            axis[i] = constants->multiplier * frames[row][3][i];
            arm[i] = origin[i] - frames[row][0][i];
            if (constants->prismatic) {
                linear[i] += axis[i];
            } else {
                angular[i] += axis[i];
            }
        }
        if (!constants->prismatic) {
            haptical_add_cross(linear, axis, arm);
        }
    }
    return HAPTICAL_OK;
}

/* A point that a link carries. */
static inline void haptical_carried(const haptical_effect *effect, haptical_frame frame, double point_m[3])
{
    for (int i = 0; i < 3; ++i) {
        point_m[i] = frame[0][i] + frame[1][i] * effect->local_m[0] + frame[2][i] * effect->local_m[1]
                     + frame[3][i] * effect->local_m[2];
    }
}

/* Moment of the hand and of the weights behind a row about a place. */
static inline void haptical_moment(const haptical_state *state, haptical_frame frames[HAPTICAL_ROWS + 1],
                                   const double force_n[3], int from_row, const double about_m[3], double moment_nm[3])
{
    double arm[3];
    for (int i = 0; i < 3; ++i) {
        arm[i] = state->position_m[i] - about_m[i];
        moment_nm[i] = 0.0;
    }
    haptical_add_cross(moment_nm, arm, force_n);
    for (int index = 0; index < HAPTICAL_EFFECTS; ++index) {
        const haptical_effect *effect = &haptical_effects[index];
        if (effect->kind == HAPTICAL_WEIGHT && effect->row >= from_row) {
            haptical_carried(effect, frames[effect->row + 1], arm);
            for (int i = 0; i < 3; ++i) {
                arm[i] -= about_m[i];
            }
            haptical_add_cross(moment_nm, arm, effect->n);
        }
    }
}

/* Two unit vectors across a joint's axis that the link before it carries along: the first one across the axis before as
   well; where the two are parallel, along the way from that axis to this one. 0 where there are none. */
static inline int haptical_across(const haptical_state *state, const haptical_effect *effect, double first[3],
                                  double second[3])
{
    const double *axis = state->jacobian_angular[effect->joint];
    double before[3] = {0.0, 0.0, 0.0};
    double length;
    int slides = 0;
    if (effect->joint_before >= 0) {
        const double *angular = state->jacobian_angular[effect->joint_before];
        slides = haptical_dot(angular, angular) < 0.5;
        for (int i = 0; i < 3; ++i) {
            before[i] = slides ? state->jacobian_linear[effect->joint_before][i] : angular[i];
        }
    } else {
        before[fabs(axis[0]) < 0.9 ? 0 : 1] = 1.0;
    }
    for (int i = 0; i < 3; ++i) {
        first[i] = 0.0;
        second[i] = 0.0;
    }
    haptical_add_cross(first, axis, before);
    length = sqrt(haptical_dot(first, first));
    if (!(length > 0.05)) {
        /* the axis's point nearest to the handle is at angular x linear from it */
        double from[3] = {0.0, 0.0, 0.0}, along;
        if (slides || effect->joint_before < 0) {
            return 0;
        }
        for (int i = 0; i < 3; ++i) {
            first[i] = 0.0;
        }
        haptical_add_cross(first, axis, state->jacobian_linear[effect->joint]);
        haptical_add_cross(from, before, state->jacobian_linear[effect->joint_before]);
        for (int i = 0; i < 3; ++i) {
            first[i] -= from[i];
        }
        along = haptical_dot(first, axis);
        for (int i = 0; i < 3; ++i) {
            first[i] -= along * axis[i];
        }
        length = sqrt(haptical_dot(first, first));
        if (!(length > 1e-3)) {
            return 0;
        }
    }
    for (int i = 0; i < 3; ++i) {
        first[i] /= length;
    }
    haptical_add_cross(second, axis, first);
    return 1;
}

/* Displacement of the handle by one effect, added to `linear` and `angular`. */
static inline int haptical_displace(int index, const haptical_compensated *device, const haptical_inputs *inputs,
                                    haptical_frame frames[HAPTICAL_ROWS + 1], const double force_n[3],
                                    double linear[3], double angular[3])
{
    const haptical_effect *effect = &haptical_effects[index];
    const haptical_state *state = &device->state;
    const double *n = effect->n;
    double about_m[3], turn[3] = {0.0, 0.0, 0.0}, arm[3];
    int turns = 0;
    switch (effect->kind) {
    case HAPTICAL_LATERAL: {
        const double *axis = state->jacobian_angular[effect->joint];
        double moment_nm[3];
        haptical_carried(effect, frames[effect->row], about_m);
        haptical_moment(state, frames, force_n, effect->row, about_m, moment_nm);
        for (int i = 0; i < 3; ++i) {
            turn[i] = (moment_nm[i] - axis[i] * haptical_dot(axis, moment_nm)) * n[0];
        }
        turns = 1;
        break;
    }
    case HAPTICAL_BASE: {
        for (int i = 0; i < 3; ++i) {
            about_m[i] = n[1 + i];
        }
        haptical_moment(state, frames, force_n, 0, about_m, turn);
        for (int i = 0; i < 3; ++i) {
            turn[i] *= n[0];
        }
        turns = 1;
        break;
    }
    case HAPTICAL_TOOL:
        haptical_slide(linear, force_n, n[0]);
        break;
    case HAPTICAL_WOBBLE: {
        const double angle_rad = n[0] * device->links[effect->joint];
        const double sine = sin(angle_rad), cosine = cos(angle_rad);
        double first[3], second[3];
        if (!(fabs(angle_rad) <= HAPTICAL_LARGEST_VALUE)) {
            return HAPTICAL_OUT_OF_RANGE;
        }
        haptical_carried(effect, frames[effect->row], about_m);
        turns = haptical_across(state, effect, first, second);
        if (turns) {
            haptical_slide(turn, first, n[1] * cosine + n[3] * sine);
            haptical_slide(turn, second, n[2] * cosine + n[4] * sine);
        }
        break;
    }
    case HAPTICAL_GROWTH:
        for (int i = 0; i < 3; ++i) {
            linear[i] += (state->position_m[i] - n[2 + i]) * (n[0] * (inputs->temperature_degc - n[1]));
        }
        break;
    case HAPTICAL_SHIFT:
        for (int i = 0; i < 3; ++i) {
            linear[i] += haptical_dot(state->rotation[i], n);
        }
        break;
    default:
        break;
    }
    if (turns) {
        for (int i = 0; i < 3; ++i) {
            arm[i] = state->position_m[i] - about_m[i];
            angular[i] += turn[i];
        }
        haptical_add_cross(linear, turn, arm);
    }
    return HAPTICAL_OK;
}

/* Moves and turns the handle: R' = exp([angular]x) R. */
static inline int haptical_move(haptical_state *state, const double linear[3], const double angular[3])
{
    const double square = haptical_dot(angular, angular);
    double sine, versine;
    for (int i = 0; i < 3; ++i) {
        if (!(fabs(linear[i]) <= HAPTICAL_LARGEST_VALUE) || !(fabs(angular[i]) <= HAPTICAL_LARGEST_VALUE)) {
            return HAPTICAL_DISPLACED;
        }
    }
    if (square < 1e-6) {
        sine = 1.0 - square / 6.0 * (1.0 - square / 20.0);
        versine = 0.5 - square / 24.0 * (1.0 - square / 30.0);
    } else {
        const double angle_rad = sqrt(square);
        sine = sin(angle_rad) / angle_rad;
        versine = (1.0 - cos(angle_rad)) / square;
    }
    for (int axis = 0; axis < 3; ++axis) {
        double column[3], once[3] = {0.0, 0.0, 0.0}, twice[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < 3; ++i) {
            column[i] = state->rotation[i][axis];
        }
        haptical_add_cross(once, angular, column);
        haptical_add_cross(twice, angular, once);
        for (int i = 0; i < 3; ++i) {
            state->rotation[i][axis] = column[i] + sine * once[i] + versine * twice[i];
        }
    }
    for (int i = 0; i < 3; ++i) {
        state->position_m[i] += linear[i];
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        haptical_add_cross(state->jacobian_linear[joint], state->jacobian_angular[joint], linear);
    }
    return HAPTICAL_OK;
}

/* What one effect adds to the torques of the drives. */
static inline int haptical_add_torque(int index, const haptical_inputs *inputs, haptical_effect_state *state,
                                      haptical_compensated *device)
{
    const haptical_effect *effect = &haptical_effects[index];
    const double *n = effect->n;
    const double rate = inputs->velocity[effect->joint];
    double *added_nm = &device->added_nm[effect->joint];
    switch (effect->kind) {
    case HAPTICAL_TORQUE_GAIN:
        device->gain[effect->joint] += n[0];
        break;
    case HAPTICAL_FRICTION_OF_TRAVEL:
    case HAPTICAL_FRICTION_OF_RATE: {
        const double slow = exp(-(rate / n[3]) * (rate / n[3]));
        double side;
        if (effect->kind == HAPTICAL_FRICTION_OF_RATE) {
            side = tanh(rate / n[4]);
        } else {
            side = haptical_step_dahl(state, index, 0, n[4], inputs->readings[effect->joint]);
            state->has_started[index] = 1;
        }
        *added_nm += n[0] * side + n[1] * rate + n[2] * (side * slow);
        break;
    }
    case HAPTICAL_COGGING: {
        const double angle_rad = n[0] * inputs->readings[effect->joint];
        if (!(fabs(angle_rad) <= HAPTICAL_LARGEST_VALUE)) {
            return HAPTICAL_OUT_OF_RANGE;
        }
        *added_nm += n[1] * cos(angle_rad) + n[2] * sin(angle_rad);
        break;
    }
    case HAPTICAL_PAYLOAD:
        for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
            for (int i = 0; i < 3; ++i) {
                device->added_nm[joint] += device->state.jacobian_linear[joint][i] * n[0]
                                           * (inputs->handle_acceleration_mps2[i] - n[1 + i]);
            }
        }
        break;
    default:
        break;
    }
    return HAPTICAL_OK;
}

/* Joint values and link angles, and the force of the hand in the handle's axes. */
static inline int haptical_drive(const haptical_inputs *inputs, haptical_effect_state *next,
                                 haptical_compensated *device, double force_n[3])
{
    int status;
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        double yielded = 0.0;
        device->state.joint = joint + 1;
        status = haptical_output(&haptical_joints[joint], inputs->readings[joint], &device->state.outputs[joint],
                                 &device->state.output_slopes[joint]);
        const double drive = device->state.outputs[joint];
        for (int index = 0; index < HAPTICAL_EFFECTS && status == HAPTICAL_OK; ++index) {
            double error, slope;
            status = haptical_drive_error(index, joint, drive, inputs, next, &error, &slope);
            device->state.outputs[joint] += error;
            device->state.output_slopes[joint] += slope;
            if (haptical_effects[index].kind == HAPTICAL_JOINT_COMPLIANCE && haptical_effects[index].joint == joint) {
                yielded += haptical_effects[index].n[0] * inputs->torque_nm[joint];
            }
        }
        if (status != HAPTICAL_OK) {
            return status;
        }
        device->links[joint] = device->state.outputs[joint] - yielded;
        device->added_nm[joint] = 0.0;
        device->gain[joint] = 0.0;
        if (!(fabs(device->links[joint]) <= HAPTICAL_LARGEST_VALUE)
            || !(fabs(device->state.outputs[joint]) <= HAPTICAL_LARGEST_VALUE)) {
            return HAPTICAL_VALUE_TOO_LARGE;
        }
    }
    device->state.joint = 0;
    for (int i = 0; i < 3; ++i) {
        force_n[i] = inputs->force_n[i];
    }
    for (int index = 0; index < HAPTICAL_EFFECTS; ++index) {
        double error_n[3];
        haptical_sensor_error(index, inputs, next, error_n);
        for (int i = 0; i < 3; ++i) {
            force_n[i] -= error_n[i];
        }
    }
    return HAPTICAL_OK;
}

/* Pose of the handle and Jacobian at the link angles. */
static inline int haptical_place(const haptical_inputs *inputs, const double force_n[3], haptical_compensated *device)
{
    haptical_frame frames[HAPTICAL_ROWS + 1];
    double turned_n[3], linear[3] = {0.0, 0.0, 0.0}, angular[3] = {0.0, 0.0, 0.0};
    int status = haptical_walk(device->links, &device->state, frames);
    if (status != HAPTICAL_OK) {
        return status;
    }
    for (int i = 0; i < 3; ++i) {
        turned_n[i] = haptical_dot(device->state.rotation[i], force_n);
    }
    for (int index = 0; index < HAPTICAL_EFFECTS && status == HAPTICAL_OK; ++index) {
        status = haptical_displace(index, device, inputs, frames, turned_n, linear, angular);
    }
    return status == HAPTICAL_OK ? haptical_move(&device->state, linear, angular) : status;
}

/* Where the device truly stands: `state` goes on by one sample, or stays where something is refused. On an error only
 * `device->state.joint` is of use. */
static inline int haptical_forward(const haptical_inputs *inputs, haptical_effect_state *state,
                                   haptical_compensated *device)
{
    haptical_effect_state next = *state;
    double force_n[3];
    int status = haptical_check_inputs(inputs);
    device->state.joint = 0;
    if (status == HAPTICAL_OK) {
        status = haptical_drive(inputs, &next, device, force_n);
    }
    if (status == HAPTICAL_OK) {
        status = haptical_place(inputs, force_n, device);
    }
    for (int index = 0; index < HAPTICAL_EFFECTS && status == HAPTICAL_OK; ++index) {
        status = haptical_add_torque(index, inputs, &next, device);
    }
    if (status != HAPTICAL_OK) {
        return status;
    }
    for (int i = 0; i < 3; ++i) {
        device->hand_force_n[i] = haptical_dot(device->state.rotation[i], force_n);
    }
    *state = next;
    return HAPTICAL_OK;
}

/* How much the value of one joint at a reading of it exceeds a wanted one. */
static inline int haptical_excess(int joint, double reading, double wanted, const haptical_inputs *inputs,
                                  const haptical_effect_state *state, double *excess)
{
    haptical_effect_state next = *state;
    haptical_inputs there = *inputs;
    double output, slope;
    int status = haptical_output(&haptical_joints[joint], reading, &output, &slope);
    const double drive = output;
    there.readings[joint] = reading;
    for (int index = 0; index < HAPTICAL_EFFECTS && status == HAPTICAL_OK; ++index) {
        double error;
        status = haptical_drive_error(index, joint, drive, &there, &next, &error, &slope);
        output += error;
    }
    *excess = output - wanted;
    return status;
}

/* The reading of one joint for a wanted value, the others as they are: outwards from the start until the sign changes, then
 * false position (Illinois) and bisection in turn. */
static inline int haptical_joint_inverse(int joint, double wanted, const haptical_inputs *inputs,
                                         const haptical_effect_state *state, double *reading)
{
    const double lower = haptical_joints[joint].lower, upper = haptical_joints[joint].upper;
    double a, at_a, b, at_b, step = 1e-3;
    int side = 0, status;
    if (!isfinite(wanted)) {
        return HAPTICAL_NOT_REACHED;
    }
    status = haptical_excess(joint, *reading, wanted, inputs, state, &at_a);
    if (status != HAPTICAL_OK || fabs(at_a) <= 1e-14) {
        return status;
    }
    a = fmin(fmax(*reading - at_a, lower), upper);
    status = haptical_excess(joint, a, wanted, inputs, state, &at_a);
    if (status != HAPTICAL_OK) {
        return status;
    }
    *reading = a;
    if (at_a == 0.0) {
        return HAPTICAL_OK;
    }
    for (int outwards = 0;; ++outwards) {
        b = fmin(fmax(a + (at_a < 0.0 ? step : -step), lower), upper);
        if (b == a || outwards == 9) {
            return HAPTICAL_NOT_REACHED;
        }
        status = haptical_excess(joint, b, wanted, inputs, state, &at_b);
        if (status != HAPTICAL_OK) {
            return status;
        }
        if (at_b == 0.0) {
            *reading = b;
            return HAPTICAL_OK;
        }
        if ((at_b < 0.0) != (at_a < 0.0)) {
            break;
        }
        a = b;
        at_a = at_b;
        step *= 4.0;
    }
    for (int round = 0; round < 120 && fabs(b - a) > 1e-15 * fmax(fmax(fabs(a), fabs(b)), 1.0); ++round) {
        const double secant = b - at_b * (b - a) / (at_b - at_a);
        const int is_inside = (secant - a) * (secant - b) < 0.0;
        double at_next;
        const double next = round % 3 == 2 || !is_inside ? 0.5 * (a + b) : secant;
        status = haptical_excess(joint, next, wanted, inputs, state, &at_next);
        if (status != HAPTICAL_OK) {
            return status;
        }
        *reading = next;
        if (at_next == 0.0) {
            return HAPTICAL_OK;
        }
        if ((at_next < 0.0) == (at_a < 0.0)) {
            a = next;
            at_a = at_next;
            if (side == 1) {
                at_b *= 0.5;
            }
            side = 1;
        } else {
            b = next;
            at_b = at_next;
            if (side == 2) {
                at_a *= 0.5;
            }
            side = 2;
        }
    }
    return HAPTICAL_OK;
}

/* Readings at the next sample for which the joints have the values `outputs`: what motors must be told. `inputs` are those
 * of that sample with the present readings; `state` is that of the present one and stays so. `joint` names the joint of an
 * error, from 1, or is 0. */
static inline int haptical_inverse(const double outputs[HAPTICAL_JOINTS], const haptical_inputs *inputs,
                                   const haptical_effect_state *state, double readings[HAPTICAL_JOINTS], int *joint)
{
    haptical_inputs next = *inputs;
    int status = haptical_check_inputs(inputs);
    *joint = 0;
    for (int round = 0; round < 30 && status == HAPTICAL_OK; ++round) {
        double moved = 0.0;
        for (int index = 0; index < HAPTICAL_JOINTS && status == HAPTICAL_OK; ++index) {
            double reading = next.readings[index];
            status = haptical_joint_inverse(index, outputs[index], &next, state, &reading);
            moved = fmax(moved, fabs(reading - next.readings[index]));
            next.readings[index] = reading;
            *joint = index + 1;
        }
        if (moved <= 1e-14) {
            break;
        }
    }
    for (int index = 0; index < HAPTICAL_JOINTS && status == HAPTICAL_OK; ++index) {
        double excess;
        *joint = index + 1;
        status = haptical_excess(index, next.readings[index], outputs[index], &next, state, &excess);
        if (status == HAPTICAL_OK && !(fabs(excess) <= 1e-10 * fmax(fabs(outputs[index]), 1.0))) {
            status = HAPTICAL_NOT_REACHED;
        }
        readings[index] = next.readings[index];
    }
    if (status == HAPTICAL_OK) {
        *joint = 0;
    }
    return status;
}

static inline int haptical_is_pose(const haptical_pose *pose)
{
    const double(*r)[3] = pose->rotation;
    double determinant = 0.0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        determinant += r[0][i] * (r[1][j] * r[2][k] - r[1][k] * r[2][j]);
        if (!(fabs(pose->position_m[i]) <= HAPTICAL_LARGEST_VALUE)) {
            return 0;
        }
        for (int row = 0; row < 3; ++row) {
            if (!(fabs(haptical_dot(r[i], r[row]) - (i == row ? 1.0 : 0.0)) <= 1e-6)) {
                return 0;
            }
        }
    }
    return determinant > 0.0;
}

/* What is left to a wanted pose: the way, and the axis of the turn times 2 sin(angle / 2), which grows up to half a turn. */
static inline void haptical_gap(const haptical_pose *wanted, const haptical_state *state, double gap[6])
{
    double turn[3][3], square = 1.0, scale;
    for (int i = 0; i < 3; ++i) {
        gap[i] = wanted->position_m[i] - state->position_m[i];
        for (int j = 0; j < 3; ++j) {
            turn[i][j] = haptical_dot(wanted->rotation[i], state->rotation[j]);
        }
        square += turn[i][i]; /* 2 cos(angle / 2), squared */
    }
    if (square > 1e-8) {
        scale = 1.0 / sqrt(square);
        for (int i = 0; i < 3; ++i) {
            gap[3 + i] = (turn[(i + 2) % 3][(i + 1) % 3] - turn[(i + 1) % 3][(i + 2) % 3]) * scale;
        }
    } else { /* half a turn, 2 a a^T - 1: the longest column of a a^T */
        double longest = 0.0;
        for (int column = 0; column < 3; ++column) {
            double own[3];
            for (int i = 0; i < 3; ++i) {
                own[i] = turn[i][column] + (i == column ? 1.0 : 0.0);
            }
            scale = haptical_dot(own, own);
            if (scale > longest) {
                longest = scale;
                for (int i = 0; i < 3; ++i) {
                    gap[3 + i] = 2.0 / sqrt(scale) * own[i];
                }
            }
        }
    }
}

static inline double haptical_gap_square(const double gap[6])
{
    return haptical_dot(gap, gap) + haptical_dot(gap + 3, gap + 3);
}

static inline int haptical_is_reached(const double gap[6])
{
    int is_reached = 1;
    for (int i = 0; i < 6; ++i) {
        is_reached = is_reached && fabs(gap[i]) <= 1e-11;
    }
    return is_reached;
}

/* Links moved by J^T (J J^T + damping)^-1 gap, no joint by more than 0.5; whether all are of bounded size. */
static inline int haptical_newton(const haptical_state *state, const double gap[6], double damping,
                                  double links[HAPTICAL_JOINTS])
{
    double matrix[6][6], weights[6], steps[HAPTICAL_JOINTS], longest = 0.5;
    int is_bounded = 1;
    for (int i = 0; i < 6; ++i) {
        weights[i] = gap[i];
        for (int j = 0; j < 6; ++j) {
            matrix[i][j] = i == j ? damping : 0.0;
            for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
                const double *linear = state->jacobian_linear[joint], *angular = state->jacobian_angular[joint];
                matrix[i][j] += (i < 3 ? linear[i] : angular[i - 3]) * (j < 3 ? linear[j] : angular[j - 3]);
            }
        }
    }
    for (int pivot = 0; pivot < 6; ++pivot) { /* positive definite: no exchanges */
        for (int i = pivot + 1; i < 6; ++i) {
            const double factor = matrix[i][pivot] / matrix[pivot][pivot];
            for (int j = pivot; j < 6; ++j) {
                matrix[i][j] -= factor * matrix[pivot][j];
            }
            weights[i] -= factor * weights[pivot];
        }
    }
    for (int i = 5; i >= 0; --i) {
        for (int j = i + 1; j < 6; ++j) {
            weights[i] -= matrix[i][j] * weights[j];
        }
        weights[i] /= matrix[i][i];
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        steps[joint] = haptical_dot(state->jacobian_linear[joint], weights)
                       + haptical_dot(state->jacobian_angular[joint], weights + 3);
        longest = fmax(longest, fabs(steps[joint]));
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        links[joint] += steps[joint] * (0.5 / longest);
        is_bounded = is_bounded && fabs(links[joint]) <= HAPTICAL_LARGEST_VALUE;
    }
    return is_bounded;
}

/* Readings at the next sample for which the handle has a pose, from the posture of the present readings: damped Newton steps
 * over the link angles (Nakamura & Hanafusa 1986), a hundred at most, then haptical_inverse. `inputs` and `state` as there;
 * they and `state` stay as they are. Beside what haptical_inverse returns: HAPTICAL_POSE_NOT_REACHED, with what is left;
 * HAPTICAL_BEYOND_LIMIT, where readings were found that are beyond the joint limits of the device; HAPTICAL_NOT_A_POSE. */
static inline int haptical_inverse_pose(const haptical_pose *wanted, const haptical_inputs *inputs,
                                        const haptical_effect_state *state, haptical_found *found)
{
    haptical_effect_state next = *state;
    haptical_compensated device, tried;
    double force_n[3], gap[6], left[6], damping = 1e-6;
    int status = haptical_check_inputs(inputs);
    found->joint = 0;
    found->left_m = 0.0;
    found->left_rad = 0.0;
    if (status == HAPTICAL_OK && !haptical_is_pose(wanted)) {
        status = HAPTICAL_NOT_A_POSE;
    }
    if (status != HAPTICAL_OK) {
        return status;
    }
    status = haptical_drive(inputs, &next, &device, force_n);
    if (status == HAPTICAL_OK) {
        status = haptical_place(inputs, force_n, &device);
    }
    if (status != HAPTICAL_OK) {
        found->joint = device.state.joint;
        return status;
    }
    haptical_gap(wanted, &device.state, gap);
    for (int step = 0; step < 100 && !haptical_is_reached(gap) && damping <= 1e6; ++step) {
        tried = device;
        if (haptical_newton(&device.state, gap, damping, tried.links)
            && haptical_place(inputs, force_n, &tried) == HAPTICAL_OK) {
            haptical_gap(wanted, &tried.state, left);
            if (haptical_gap_square(left) < haptical_gap_square(gap)) {
                device = tried;
                for (int i = 0; i < 6; ++i) {
                    gap[i] = left[i];
                }
                damping = fmax(0.1 * damping, 1e-14);
                continue;
            }
        }
        damping *= 10.0;
    }
    found->left_m = sqrt(haptical_dot(gap, gap));
    found->left_rad = sqrt(haptical_dot(gap + 3, gap + 3));
    if (!haptical_is_reached(gap)) {
        return HAPTICAL_POSE_NOT_REACHED;
    }
    for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
        found->outputs[joint] = device.links[joint];
    }
    for (int index = 0; index < HAPTICAL_EFFECTS; ++index) {
        const haptical_effect *effect = &haptical_effects[index];
        if (effect->kind == HAPTICAL_JOINT_COMPLIANCE) {
            found->outputs[effect->joint] += effect->n[0] * inputs->torque_nm[effect->joint];
        }
    }
    status = haptical_inverse(found->outputs, inputs, state, found->readings, &found->joint);
    return status == HAPTICAL_OK ? haptical_check_limits(found->readings, &found->joint) : status;
}

/* Torques that the drives must read, at the joint axes, so that the device exerts a force and a moment on the hand: times
 * output_slopes they are what the readings see. */
static inline int haptical_drive_torques(const haptical_compensated *device, const double force_n[3],
                                         const double moment_nm[3], double torques_nm[HAPTICAL_JOINTS])
{
    const int status = haptical_torques(&device->state, force_n, moment_nm, NULL, torques_nm);
    for (int joint = 0; joint < HAPTICAL_JOINTS && status == HAPTICAL_OK; ++joint) {
        torques_nm[joint] = (torques_nm[joint] + device->added_nm[joint]) / (1.0 - device->gain[joint]);
        if (!isfinite(torques_nm[joint])) {
            return HAPTICAL_VALUE_TOO_LARGE;
        }
    }
    return status;
}

