/* Times implementations of {Φ, Φ_q, Φ_t, γ} of the lecture's four-bar against each other in one process.

       evaluation [ROUNDS]

   In every round each implementation evaluates the same 256 states of a turn again and again and stores what it
   finds; ratios are formed within a round, so that the machine's moods cancel. Prints one line for each
   implementation: name, time a call (ns, median), CasADi's time over its time (median, 10 %, 90 %), and its largest
   difference from CasADi's plain code, each row measured by its largest value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sparsity.h"

enum { N = 5, PHI = 0, PHI_Q = 5, PHI_T = 30, GAMMA = 35, OUTPUTS = 40, STATES = 256, LANES = 8, MOST_ROUNDS = 1001 };

typedef void evaluation(const double *q, const double *qd, double t, double *out);

evaluation emitted, by_hand, by_hand_c_library, differences;
void emitted_lanes(const double *q, const double *qd, const double *t, double *out);
void adjustable_design(double *design);
void emitted_adjustable(const double *design, const double *q, const double *qd, double t, double *out);
int casadi_plain(const double **arg, double **res, long long *iw, double *w, int mem);
int casadi_shared(const double **arg, double **res, long long *iw, double *w, int mem);

static double Q[STATES][N], QD[STATES][N], T[STATES];
static double lanes_q[STATES / LANES][N][LANES], lanes_qd[STATES / LANES][N][LANES], lanes_t[STATES / LANES][LANES];
static double design[16];
/* CasADi stores the entries of Φ_q that are not zero, ours stores all of them. */
static double out[OUTPUTS], lanes_out[OUTPUTS][LANES];

static void run_casadi(int (*f)(const double **, double **, long long *, double *, int), int k) {
    const double *arg[3] = {Q[k], QD[k], &T[k]};
    double *res[4] = {out, out + N, out + N + NONZEROS, out + 2 * N + NONZEROS};
    f(arg, res, 0, 0, 0);
}

/* One call each; not inlined into one another, because they lie in other files. */
static void call_casadi_plain(int k) { run_casadi(casadi_plain, k); }
static void call_casadi_shared(int k) { run_casadi(casadi_shared, k); }
static void call_emitted(int k) { emitted(Q[k], QD[k], T[k], out); }
static void call_adjustable(int k) { emitted_adjustable(design, Q[k], QD[k], T[k], out); }
static void call_by_hand(int k) { by_hand(Q[k], QD[k], T[k], out); }
static void call_by_hand_c_library(int k) { by_hand_c_library(Q[k], QD[k], T[k], out); }
static void call_differences(int k) { differences(Q[k], QD[k], T[k], out); }
static void call_lanes(int k) {
    if (k % LANES == 0) emitted_lanes(lanes_q[k / LANES][0], lanes_qd[k / LANES][0], lanes_t[k / LANES], lanes_out[0]);
}

static const struct { const char *name; void (*call)(int); } IMPLEMENTATIONS[] = {
    {"casadi_plain", call_casadi_plain},
    {"casadi_shared", call_casadi_shared},
    {"emitted", call_emitted},
    {"emitted_adjustable", call_adjustable},
    {"emitted_lanes", call_lanes},
    {"by_hand", call_by_hand},
    {"by_hand_c_library", call_by_hand_c_library},
    {"differences", call_differences},
};
enum { COUNT = sizeof IMPLEMENTATIONS / sizeof *IMPLEMENTATIONS };

/* States near a turn of the mechanism; they need not close the loop. */
static void make_states(void) {
    for (int k = 0; k < STATES; k++) {
        double phase = 2 * M_PI * k / STATES;
        double q[N] = {0.3 + 0.2 * cos(phase), 0.4 + 0.1 * sin(phase), phase, 0.8 + 0.4 * cos(phase), 1.8 + 0.5 * sin(phase)};
        double qd[N] = {0.5 * sin(phase), -1.2 * cos(phase), 2 * M_PI, -2.5 * sin(phase), 3.1 * cos(phase)};
        memcpy(Q[k], q, sizeof q);
        memcpy(QD[k], qd, sizeof qd);
        T[k] = 0.05 + k / (double)STATES;
        for (int i = 0; i < N; i++) {
            lanes_q[k / LANES][i][k % LANES] = q[i];
            lanes_qd[k / LANES][i][k % LANES] = qd[i];
        }
        lanes_t[k / LANES][k % LANES] = T[k];
    }
    adjustable_design(design);
}

/* All 40 numbers of one state, whatever the implementation's layout. */
static void dense(int implementation, int k, double *to) {
    memset(out, 0, sizeof out);
    if (IMPLEMENTATIONS[implementation].call == call_lanes) {
        call_lanes(k - k % LANES);
        for (int i = 0; i < OUTPUTS; i++) to[i] = lanes_out[i][k % LANES];
        return;
    }
    IMPLEMENTATIONS[implementation].call(k);
    memcpy(to, out, sizeof out);
    if (implementation < 2) {
        memset(to + PHI_Q, 0, N * N * sizeof *to);
        for (int i = 0; i < NONZEROS; i++) to[PHI_Q + PLACES[i]] = out[N + i];
        memcpy(to + PHI_T, out + N + NONZEROS, 2 * N * sizeof *to);
    }
}

/* Largest difference from CasADi's plain code, each of the 20 rows measured by its largest value over the states. */
static double largest_error(int implementation) {
    static double expected[STATES][OUTPUTS], found[STATES][OUTPUTS];
    double largest = 0, scale[OUTPUTS] = {0};
    for (int k = 0; k < STATES; k++) {
        dense(0, k, expected[k]);
        dense(implementation, k, found[k]);
        for (int i = 0; i < OUTPUTS; i++) {
            int row = i < PHI_Q || i >= PHI_T ? i : PHI_Q + (i - PHI_Q) / N;
            scale[row] = fmax(scale[row], fabs(expected[k][i]));
        }
    }
    for (int k = 0; k < STATES; k++)
        for (int i = 0; i < OUTPUTS; i++) {
            int row = i < PHI_Q || i >= PHI_T ? i : PHI_Q + (i - PHI_Q) / N;
            double error = fabs(found[k][i] - expected[k][i]) / (scale[row] > 0 ? scale[row] : 1);
            largest = error > largest || isnan(error) ? error : largest;
        }
    return largest;
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1e9 + time.tv_nsec;
}

static double time_of(int implementation, long calls) {
    void (*call)(int) = IMPLEMENTATIONS[implementation].call;
    double start = now();
    for (long i = 0; i < calls; i++) call((int)(i % STATES));
    return (now() - start) / calls;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    static double times[COUNT][MOST_ROUNDS], sorted[MOST_ROUNDS], ratios[MOST_ROUNDS];
    int rounds = argc > 1 ? atoi(argv[1]) : 101;
    if (rounds < 1 || rounds > MOST_ROUNDS) return 2;
    make_states();
    double errors[COUNT];
    long calls[COUNT];
    for (int i = 0; i < COUNT; i++) {
        errors[i] = largest_error(i);
        time_of(i, 64 * STATES); /* warm */
        /* About two milliseconds a round, in whole turns. */
        calls[i] = ((long)(2e6 / time_of(i, 64 * STATES)) / STATES + 1) * STATES;
    }
    for (int round = 0; round < rounds; round++)
        for (int j = 0; j < COUNT; j++) {
            int i = (j + round * 3) % COUNT; /* another order in every round */
            times[i][round] = time_of(i, calls[i]);
        }
    for (int i = 0; i < COUNT; i++) {
        for (int round = 0; round < rounds; round++) {
            sorted[round] = times[i][round];
            /* The faster of CasADi's two. */
            ratios[round] = fmin(times[0][round], times[1][round]) / times[i][round];
        }
        qsort(sorted, rounds, sizeof *sorted, by_size);
        qsort(ratios, rounds, sizeof *ratios, by_size);
        printf("%s %.17g %.17g %.17g %.17g %.17g\n", IMPLEMENTATIONS[i].name, sorted[rounds / 2], ratios[rounds / 2],
               ratios[rounds / 10], ratios[rounds - 1 - rounds / 10], errors[i]);
    }
    return 0;
}
