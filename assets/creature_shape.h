#pragma once
// A creature for games, in metres: a small, plump, horned thing on four feet, x to its nose, y up, alike on both sides of z = 0. 0.35 m from nose to tail.
#include "shapes.h"

namespace supple_assets {

/// Centre of its left eye (z > 0); the right one is its mirror image.
inline Point creature_eye() { return {0.1490, 0.1670, 0.0400}; }
inline constexpr double kCreatureEyeRadius_m = 0.0120;

inline double creature(const Point& p) {
    const Point x = mirrored_z(p);
    // Trunk, neck, belly.
    double d = ellipsoid(x, {-0.005, 0.085, 0}, {0.085, 0.062, 0.060});
    d = blend(d, ellipsoid(x, {-0.045, 0.080, 0}, {0.062, 0.058, 0.062}), 0.030);
    d = blend(d, capsule(x, {0.045, 0.100, 0}, {0.092, 0.140, 0}, 0.042, 0.040), 0.035);
    // Head: a round skull, cheeks, a broad snout with nostrils and the line of a mouth that smiles.
    double head = ellipsoid(x, {0.112, 0.160, 0}, {0.056, 0.053, 0.055});
    head = blend(head, ellipsoid(x, {0.158, 0.140, 0}, {0.036, 0.028, 0.036}), 0.030);
    head = blend(head, sphere(x, {0.132, 0.136, 0.030}, 0.024), 0.020);
    head = blend(head, sphere(x, {0.141, 0.176, 0.032}, 0.016), 0.016);  // brow
    head = carve(head, sphere(x, creature_eye() + Point(0.004, 0.002, 0.006), 0.0125), 0.008);  // socket
    head = carve(head, sphere(x, {0.195, 0.150, 0.013}, 0.0065), 0.006);
    head = carve(head, tube(x, {{{0.199, 0.130, 0.0}, 0.0036}, {{0.190, 0.1285, 0.022}, 0.0036}, {{0.170, 0.130, 0.0385}, 0.0036}, {{0.153, 0.137, 0.048}, 0.0030}}), 0.006);
    // Ears like leaves, horns between them.
    head = blend(head, tube(x, {{{0.096, 0.186, 0.040}, 0.015}, {{0.086, 0.208, 0.062}, 0.0185}, {{0.074, 0.224, 0.084}, 0.0075}}), 0.010);
    head = carve(head, ellipsoid(x, {0.108, 0.216, 0.066}, {0.010, 0.014, 0.015}), 0.012);
    head = blend(head, tube(x, {{{0.122, 0.200, 0.017}, 0.0105}, {{0.123, 0.221, 0.022}, 0.0080}, {{0.113, 0.240, 0.026}, 0.0050}}), 0.006);
    d = blend(d, head, 0.022);
    // Feet like a young elephant's, toes in front.
    const auto leg = [&](double at, double hip, double lean) {
        double l = capsule(x, {at, hip, 0.034}, {at + lean, 0.020, 0.046}, 0.030, 0.024);
        l = blend(l, ellipsoid(x, {at + lean + 0.006, 0.014, 0.047}, {0.029, 0.016, 0.025}), 0.012);
        for (const double side : {-0.015, 0.0, 0.015}) l = blend(l, sphere(x, {at + lean + 0.028 - 20 * side * side, 0.0095, 0.047 + side}, 0.0095), 0.004);
        return l;
    };
    d = blend(d, leg(0.045, 0.070, 0.008), 0.018);
    d = blend(d, leg(-0.068, 0.066, -0.002), 0.018);
    // Tail: down and up again, with a knob; a comb of knobs over the back.
    d = blend(d, tube(x, {{{-0.085, 0.086, 0}, 0.036}, {{-0.125, 0.074, 0}, 0.024}, {{-0.155, 0.082, 0}, 0.017}, {{-0.172, 0.108, 0}, 0.012}}), 0.020);
    d = blend(d, sphere(x, {-0.174, 0.120, 0}, 0.0175), 0.010);
    constexpr std::array<std::array<double, 3>, 6> comb{{{0.062, 0.168, 0.011}, {0.030, 0.152, 0.013}, {-0.008, 0.149, 0.0145}, {-0.046, 0.143, 0.0135}, {-0.082, 0.128, 0.0115}, {-0.114, 0.104, 0.009}}};
    for (const auto& [cx, cy, r] : comb) d = blend(d, ellipsoid(x, {cx, cy - 0.004, 0}, {1.05 * r, 1.25 * r, 0.62 * r}), 0.008);
    return d;
}

}  // namespace supple_assets
