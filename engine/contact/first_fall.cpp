#include "supple/contact/first_fall.h"

#include <array>
#include <cmath>
#include <utility>

namespace supple::contact {

std::optional<double> first_fall(double a, double b, double c, double d) {
    const auto f = [&](double t) { return a + t * (b + t * (c + t * d)); };
    std::array<double, 4> cut{0, 1, 1, 1};
    std::size_t cuts = 1;
    const double p = 3 * d, q = 2 * c, disc = q * q - 4 * p * b;  // extremes: p t^2 + q t + b = 0
    if (disc >= 0) {
        const double root = -0.5 * (q + std::copysign(std::sqrt(disc), q));
        double t1 = p != 0 ? root / p : 2, t2 = root != 0 ? b / root : 2;
        if (t1 > t2) std::swap(t1, t2);
        for (const double t : {t1, t2}) {
            if (t > 0 && t < 1) cut[cuts++] = t;
        }
    }
    cut[cuts] = 1;
    for (std::size_t i = 0; i < cuts; ++i) {
        double low = cut[i], high = cut[i + 1];
        if (!(f(low) >= 0 && f(high) < 0)) continue;
        for (int k = 0; k < 60; ++k) {
            const double mid = 0.5 * (low + high);
            (f(mid) >= 0 ? low : high) = mid;
        }
        return low;
    }
    return {};
}

}  // namespace supple::contact
