#pragma once
#include <Eigen/Geometry>
#include <cstdint>

#include "supple/math/types.h"

namespace supple::verify {

/// The same numbers on every machine: splitmix64.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double uniform(double low, double high) {
        state_ += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        z ^= z >> 31;
        return low + (high - low) * (double(z >> 11) * 0x1p-53);
    }
    Vec3 vector(double size) {
        Vec3 v;
        for (int i = 0; i < 3; ++i) v[i] = uniform(-size, size);
        return v;
    }
    Mat3 matrix(double size) {
        Mat3 A;
        for (int i = 0; i < 9; ++i) A(i / 3, i % 3) = uniform(-size, size);
        return A;
    }
    Mat3 rotation() {
        for (;;) {
            Eigen::Vector4d q;
            for (int i = 0; i < 4; ++i) q[i] = uniform(-1, 1);
            if (q.norm() > 0.1 && q.norm() < 1) return Eigen::Quaterniond(q / q.norm()).toRotationMatrix();
        }
    }

private:
    std::uint64_t state_;
};

}  // namespace supple::verify
