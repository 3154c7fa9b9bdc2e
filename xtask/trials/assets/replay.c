/* A recording through an exported device: see compiled.rs. */
#include <stdio.h>
#include "model.h"

int main(void)
{
    double row[4 * HAPTICAL_JOINTS + 6];
    haptical_effect_state state;
    haptical_reset_state(&state);
    while (fread(row, sizeof row, 1, stdin) == 1) {
        const double *rest = row + 4 * HAPTICAL_JOINTS;
        haptical_inputs inputs = {0};
        haptical_compensated device;
        for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
            inputs.readings[joint] = row[joint];
            inputs.torque_nm[joint] = row[HAPTICAL_JOINTS + joint];
            inputs.velocity[joint] = row[2 * HAPTICAL_JOINTS + joint];
            inputs.acceleration[joint] = row[3 * HAPTICAL_JOINTS + joint];
        }
        for (int i = 0; i < 3; ++i) {
            inputs.force_n[i] = rest[i];
        }
        inputs.time_s = rest[3];
        inputs.temperature_degc = rest[4];
        if (rest[5] != 0.0) {
            haptical_reset_state(&state);
        }
        if (haptical_forward(&inputs, &state, &device) != HAPTICAL_OK) {
            /* no numbers: the row is refused */
            for (int joint = 0; joint < HAPTICAL_JOINTS; ++joint) {
                device.state.outputs[joint] = NAN;
            }
            for (int i = 0; i < 3; ++i) {
                device.state.position_m[i] = NAN;
            }
        }
        if (fwrite(device.state.outputs, sizeof device.state.outputs, 1, stdout) != 1
            || fwrite(device.state.position_m, sizeof device.state.position_m, 1, stdout) != 1) {
            return 1;
        }
    }
    return 0;
}
