/* A wiper for a control loop: functions of src/lib.rs. */
#include <stddef.h>
#include <stdint.h>

#define WIPER_SIZE 512

typedef struct {
    _Alignas(64) unsigned char bytes[WIPER_SIZE];
} wiper;

enum { WIPER_DONE = 0, WIPER_DEGRADED = 1, WIPER_REFUSED = 2 };

int wiper_start(wiper *place, float angle);
int wiper_step(wiper *motion, float period, float angle, float rate, float *blade);
size_t wiper_save(const wiper *motion, uint8_t *page, size_t length);
int wiper_restore(wiper *place, const uint8_t *page, size_t length, float angle);
