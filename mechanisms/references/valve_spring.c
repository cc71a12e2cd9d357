/* The valve of `mechanisms/src/valve_spring.rs` by the method of Runge and Kutta in equal steps: one degree of freedom, laws as
   they stand in the text. It shares no code with the library.

       cc -O2 valve_spring.c -lm -o valve_spring && ./valve_spring > valve_spring.txt

   A line for each instant of a case: case, t (s), y (m), y' (m/s), force of the cam (N). The lines `floats` have the speed (rad/s)
   above which the face leaves the cam while this is above half of its lift, in the first turn: of the text, and without play,
   friction and pressure. */
#include <math.h>
#include <stdio.h>

static const double G = 9.81, H = 0.009, M = 0.15, PRELOAD = 150, SPRING = 18000, CONTACT = 2e7;
static double speed, play, mu, pressure, d;

static double lift(double t) { return H * pow((1 - cos(speed * t)) / 2, 4); }

static double lift_rate(double t) { return H * 2 * speed * pow((1 - cos(speed * t)) / 2, 3) * sin(speed * t); }

static double pushed(double depth, double rate) {
    return depth > 0 ? CONTACT * depth * fmax(1 + d * rate, 0) : 0;
}

static double cam(double t, double y, double v) { return pushed(lift(t) - y - play, lift_rate(t) - v); }

static double acceleration(double t, double y, double v) {
    double gas = M_PI / 4 * 0.03 * 0.03 * pressure * pow((1 + cos(speed * t)) / 2, 2);
    double guide = mu * 30 * tanh(v / 0.01);
    return (cam(t, y, v) + pushed(-y, -v) - PRELOAD - SPRING * y - guide - gas) / M - G;
}

static void step(double t, double h, double *y, double *v) {
    double a = acceleration(t, *y, *v), u = *v + h / 2 * a;
    double b = acceleration(t + h / 2, *y + h / 2 * *v, u), w = *v + h / 2 * b;
    double c = acceleration(t + h / 2, *y + h / 2 * u, w), x = *v + h * c;
    double e = acceleration(t + h, *y + h * w, x);
    *y += h / 6 * (*v + 2 * u + 2 * w + x);
    *v += h / 6 * (a + 2 * b + 2 * c + e);
}

static void motion(const char *name, double until, int lines) {
    long parts = 100000;
    double y = 0, v = 0, h = until / lines / parts;
    for (int line = 1; line <= lines; line++) {
        for (long part = 0; part < parts; part++) step(((line - 1) * parts + part) * h, h, &y, &v);
        double t = until * line / lines;
        printf("%s %.17g %.12g %.12g %.12g\n", name, t, y, v, cam(t, y, v));
    }
}

static int floats(double at) {
    long parts = 400000;
    double y = 0, v = 0, h;
    speed = at;
    h = 2 * M_PI / speed / parts;
    for (long part = 0; part < parts; part++) {
        step(part * h, h, &y, &v);
        double t = (part + 1) * h;
        if (lift(t) > H / 2 && cam(t, y, v) == 0) return 1;
    }
    return 0;
}

static void border(const char *name) {
    double low = 250, high = 420;
    while (high - low > 1e-7 * low) {
        double middle = (low + high) / 2;
        if (floats(middle)) high = middle; else low = middle;
    }
    printf("floats %s %.9g\n", name, low);
}

static void text(void) { play = 0.0001; mu = 0.1; pressure = 2e5; }

int main(void) {
    /* c - ln(1 + c) = -e c - ln(1 - e c) between the double root at 0 and 1/e. */
    double e = 0.3, low = 1e-3, high = 1 / e * (1 - 1e-15);
    for (int k = 0; k < 200; k++) {
        double c = (low + high) / 2;
        if (c - log1p(c) + e * c + log1p(-e * c) > 0) low = c; else high = c;
    }
    d = low / 0.2;
    text();
    speed = 2500 * 2 * M_PI / 60;
    motion("holds", 0.048, 16);
    speed = 4200 * 2 * M_PI / 60;
    motion("floats_at_4200", 0.03, 16);
    border("text");
    play = mu = pressure = 0;
    border("bare");
    return 0;
}
