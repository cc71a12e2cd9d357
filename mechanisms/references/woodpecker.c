/* The woodpecker toy by Moreau's time-stepping: steps of equal size without events, impulses of each step by enumeration of modes.
   It shares no code and no method with the library.

   Coordinates: y height of the sleeve, a angle of the sleeve, b angle of the bird. Contacts: 1 beak on the pole, 2 lower and 3 upper
   edge of the sleeve. Source of model and data: Glocker & Studer 2005, after Glocker 1995 and Pfeiffer 1984.

   woodpecker STEP DURATION: a line for each strike of the beak, 20 ms or more after the last: time, y, a, b, and the rates after it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double mM = 0.0003, JM = 5e-9, mS = 0.0045, JS = 7e-7, c = 0.0056, g = 9.81;
static const double r0 = 0.0025, rM = 0.0031, hM = 0.0058, lM = 0.010, lG = 0.015, hS = 0.02, lS = 0.0201;
static const double mu = 0.3, e[3] = {0.5, 0.0, 0.0};

/* Solves A x = b by elimination with pivoting; 0 where A is singular. */
static int solve(int n, double A[6][6], double *b) {
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k; i < n; i++) if (fabs(A[i][k]) > fabs(A[p][k])) p = i;
        if (A[p][k] == 0) return 0;
        for (int j = 0; j < n; j++) { double t = A[k][j]; A[k][j] = A[p][j]; A[p][j] = t; }
        double t = b[k]; b[k] = b[p]; b[p] = t;
        for (int i = 0; i < n; i++) if (i != k) {
            double s = A[i][k] / A[k][k];
            for (int j = k; j < n; j++) A[i][j] -= s * A[k][j];
            b[i] -= s * b[k];
        }
    }
    for (int k = 0; k < n; k++) b[k] /= A[k][k];
    return 1;
}

int main(int count, char **words) {
    double h = count > 1 ? atof(words[1]) : 1e-6, end = count > 2 ? atof(words[2]) : 1.0;
    double M[3][3] = {
        {mM + mS, mS * lM, mS * lG}, {mS * lM, JM + mS * lM * lM, mS * lM * lG}, {mS * lG, mS * lM * lG, JS + mS * lG * lG}};
    double N[3][3] = {{0, 0, -hS}, {0, hM, 0}, {0, -hM, 0}};
    double T[3][3] = {{1, lM, lG - lS}, {1, rM, 0}, {1, rM, 0}};
    double gap0[3] = {lM + lG - lS - r0, rM - r0, rM - r0};
    double q[3] = {0, -0.1034, -0.2788}, u[3] = {-0.3411, 0, -7.4583}, J[6][3], A[6][3], W[6][6], last = -1;
    for (int i = 0; i < 3; i++) for (int k = 0; k < 3; k++) { J[i][k] = N[i][k]; J[3 + i][k] = T[i][k]; }
    for (int i = 0; i < 6; i++) {
        double m[6][6], x[6];
        for (int k = 0; k < 3; k++) { x[k] = J[i][k]; for (int l = 0; l < 3; l++) m[k][l] = M[k][l]; }
        solve(3, m, x);
        for (int k = 0; k < 3; k++) A[i][k] = x[k];
    }
    for (int i = 0; i < 6; i++) for (int j = 0; j < 6; j++) {
        W[i][j] = 0;
        for (int k = 0; k < 3; k++) W[i][j] += J[i][k] * A[j][k];
    }
    for (long step = 0; step * h < end; step++) {
        double m[6][6], f[6], middle[3], v[6], free[6], P[6] = {0}, before = u[2];
        int close[3];
        for (int k = 0; k < 3; k++) middle[k] = q[k] + h / 2 * u[k];
        f[0] = -(mM + mS) * g;
        f[1] = -c * (middle[1] - middle[2]) - mS * g * lM;
        f[2] = -c * (middle[2] - middle[1]) - mS * g * lG;
        for (int k = 0; k < 3; k++) for (int l = 0; l < 3; l++) m[k][l] = M[k][l];
        solve(3, m, f);
        for (int i = 0; i < 6; i++) {
            v[i] = free[i] = 0;
            for (int k = 0; k < 3; k++) { v[i] += J[i][k] * u[k]; free[i] += J[i][k] * (u[k] + h * f[k]); }
        }
        for (int i = 0; i < 3; i++) {
            double gap = gap0[i];
            for (int k = 0; k < 3; k++) gap += N[i][k] * middle[k];
            close[i] = gap <= 0;
        }
        /* Modes of each contact: 0 open, 1 sticking, 2 and 3 sliding forwards and backwards. */
        int found = 0;
        for (int code = 0; code < 64 && !found; code++) {
            int mode[3] = {code % 4, code / 4 % 4, code / 16};
            double B[6][6] = {{0}}, x[6];
            int possible = 1;
            for (int i = 0; i < 3; i++) if (mode[i] && !close[i]) possible = 0;
            if (!possible) continue;
            for (int i = 0; i < 3; i++) {
                int t = 3 + i;
                x[i] = x[t] = 0;
                if (!mode[i]) { B[i][i] = B[t][t] = 1; continue; }
                for (int j = 0; j < 6; j++) B[i][j] = W[i][j];
                x[i] = -free[i] - e[i] * v[i];
                if (mode[i] == 1) { for (int j = 0; j < 6; j++) B[t][j] = W[t][j]; x[t] = -free[t]; }
                else { B[t][t] = 1; B[t][i] = mode[i] == 2 ? mu : -mu; }
            }
            if (!solve(6, B, x)) continue;
            for (int i = 0; i < 3 && possible; i++) {
                double n = free[i] + e[i] * v[i], s = free[3 + i];
                for (int j = 0; j < 6; j++) { n += W[i][j] * x[j]; s += W[3 + i][j] * x[j]; }
                if (!mode[i]) possible = !close[i] || n >= -1e-15;
                else if (mode[i] == 1) possible = x[i] >= 0 && fabs(x[3 + i]) <= mu * x[i] * (1 + 1e-12);
                else possible = x[i] >= 0 && (mode[i] == 2 ? s >= -1e-15 : s <= 1e-15);
            }
            if (possible) { found = 1; for (int j = 0; j < 6; j++) P[j] = mode[j % 3] ? x[j] : 0; }
        }
        if (!found) { fprintf(stderr, "no mode at %.9f s\n", step * h); return 1; }
        for (int k = 0; k < 3; k++) {
            double after = u[k] + h * f[k];
            for (int j = 0; j < 6; j++) after += A[j][k] * P[j];
            u[k] = after;
            q[k] = middle[k] + h / 2 * u[k];
        }
        if (P[0] > 0 && before > 1 && step * h - last > 0.02) {
            last = step * h;
            printf("%.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", step * h, q[0], q[1], q[2], u[0], u[1], u[2]);
        }
    }
    return 0;
}
