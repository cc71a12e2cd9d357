/* The loop: steps of a millisecond, a sensor that fails once, a reset. */
#include "wiper.h"
#include <math.h>
#include <stdio.h>

int main(void) {
    static wiper motion, again;
    static uint8_t page[256];
    float blade = 0.0f;
    int refused = 0;
    if (wiper_start(&motion, 0.0f) != WIPER_DONE) {
        return 1;
    }
    for (int tick = 1; tick <= 2000; tick++) {
        float angle = tick == 1000 ? NAN : fmodf(6.0f * 1e-3f * (float)tick, 6.28318531f);
        if (wiper_step(&motion, 1e-3f, angle, 6.0f, &blade) == WIPER_REFUSED) {
            refused++; /* The command is held; the next step makes up for it. */
        }
    }
    printf("blade %.5f rad, %d refused\n", blade, refused);
    size_t length = wiper_save(&motion, page, sizeof page);
    float angle = fmodf(12.0f, 6.28318531f);
    if (length == 0 || wiper_restore(&again, page, length, angle) != WIPER_DONE) {
        return 1;
    }
    page[20] ^= 1;
    int damaged = wiper_restore(&again, page, length, angle);
    wiper_step(&again, 1e-3f, angle, 0.0f, &blade);
    printf("blade %.5f rad after a reset from %zu bytes, damaged page %d\n", blade, length, damaged);
    return 0;
}
