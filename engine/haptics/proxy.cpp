#include "supple/haptics/proxy.h"

#include <Eigen/LU>

namespace supple::haptics {

namespace {

constexpr int kMostSweeps = 60;
constexpr double kSettled = 1e-4;  // of the sum of forces: far below what a hand tells apart

}  // namespace

void Proxy::adopt(const LocalModel& model) noexcept {
    model_.copy_from(model);
    for (std::size_t i = 0; i < model_.contacts; ++i) {
        r_[i] = model_.contact[i].force_n;
        anchor_[i] = Vec3::Zero();  // the simulation's forces are those of its own slide
    }
}

Vec3 Proxy::solve(const Vec3& x, double stiffness, double age_s) noexcept {
    const std::size_t n = model_.contacts;
    const double soft = 1 / stiffness, age = std::min(age_s, model_.step_s);
    const auto block = [&](std::size_t i, std::size_t j, const Vec3& r) {
        const double* w = &model_.compliance[3 * i * 3 * n + 3 * j];
        const std::size_t row = 3 * n;
        return Vec3(w[0] * r[0] + w[1] * r[1] + w[2] * r[2], w[row] * r[0] + w[row + 1] * r[1] + w[row + 2] * r[2],
                    w[2 * row] * r[0] + w[2 * row + 1] * r[1] + w[2 * row + 2] * r[2]);
    };
    Vec3 sum = Vec3::Zero();
    for (std::size_t j = 0; j < n; ++j) sum += r_[j];
    for (std::size_t i = 0; i < n; ++i) {
        const LocalContact& c = model_.contact[i];
        s_[i] = c.gap_m * c.normal + (x - model_.tool_m) - age * c.velocity_m_s + soft * sum;
        for (std::size_t j = 0; j < n; ++j) s_[i] += block(i, j, r_[j] - model_.contact[j].force_n);
    }
    for (sweeps_ = 0; sweeps_ < kMostSweeps && n > 0; ++sweeps_) {
        double moved = 0, total = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const LocalContact& c = model_.contact[i];
            if (c.holds) {
                Mat3 D = soft * Mat3::Identity();
                for (std::size_t e = 0; e < 9; ++e) D(Eigen::Index(e / 3), Eigen::Index(e % 3)) += model_.W(3 * i + e / 3, 3 * i + e % 3);
                const Vec3 change = -(D.inverse() * s_[i]);
                r_[i] += change;
                total += r_[i].norm();
                moved += change.norm();
                for (std::size_t j = 0; j < n; ++j) s_[j] += soft * change + block(j, i, change);
                continue;
            }
            const Vec3& normal = c.normal;
            const Vec3 answer = block(i, i, normal);
            const double along = soft + normal.dot(answer);
            const double trace = model_.W(3 * i, 3 * i) + model_.W(3 * i + 1, 3 * i + 1) + model_.W(3 * i + 2, 3 * i + 2);
            const double across = soft + trace - std::min(trace / 3, normal.dot(answer));  // at least as large as any diagonal across: never overshoots
            const double pressing = std::max(0.0, normal.dot(r_[i]) - normal.dot(s_[i]) / along);
            const Vec3 slide = s_[i] - anchor_[i];
            Vec3 rubbing = r_[i] - normal.dot(r_[i]) * normal - (slide - normal.dot(slide) * normal) / across;
            const double size = rubbing.norm(), limit = c.friction * pressing;
            if (size > limit) rubbing *= limit / size;
            const Vec3 r = pressing * normal + rubbing, change = r - r_[i];
            total += r.norm();
            if (change.squaredNorm() == 0) continue;
            moved += change.norm();
            r_[i] = r;
            for (std::size_t j = 0; j < n; ++j) s_[j] += soft * change + block(j, i, change);
        }
        if (moved <= kSettled * total) break;
    }
    sum = Vec3::Zero();
    touching_ = 0;
    penetration_ = 0;
    for (std::size_t j = 0; j < n; ++j) {
        sum += r_[j];
        touching_ += r_[j].squaredNorm() > 0;
        if (!model_.contact[j].holds) penetration_ = std::max(penetration_, -model_.contact[j].normal.dot(s_[j]));
    }
    p_ = x + soft * sum;
    return sum;
}

void Proxy::settle() noexcept {
    for (std::size_t i = 0; i < model_.contacts; ++i) {
        const LocalContact& c = model_.contact[i];
        if (c.holds) continue;
        const double pressing = c.normal.dot(r_[i]);
        const Vec3 rubbing = r_[i] - pressing * c.normal, slide = s_[i] - c.normal.dot(s_[i]) * c.normal;
        // What is free, or at the cone, goes on from where it is.
        if (!(pressing > 0) || rubbing.norm() >= c.friction * pressing * (1 - 1e-9)) anchor_[i] = slide;
    }
}

}  // namespace supple::haptics
