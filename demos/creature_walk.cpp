#include "creature_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "touch_script.h"

namespace supple::demos {
namespace {

constexpr double kSky_m = 1.0;    // feelers for the ground start here
constexpr double kRound_m = 0.06; // of the route: directions are means over twice this length

Mat3 axes(const Vec3& ahead) {
    Mat3 R;
    R << ahead, Vec3(0, 1, 0), ahead.cross(Vec3(0, 1, 0));
    return R;
}

}  // namespace

double Route::length_m() const {
    double sum = 0;
    for (std::size_t i = 1; i < points_m.size(); ++i) sum += (points_m[i] - points_m[i - 1]).norm();
    return sum;
}

Route::Place Route::at(double way_m) const {
    const auto on = [&](double way) {
        for (std::size_t i = 1; i < points_m.size(); ++i) {
            const Vec3 part = points_m[i] - points_m[i - 1];
            if (way <= part.norm() || i + 1 == points_m.size()) return Vec3(points_m[i - 1] + way * part.normalized());
            way -= part.norm();
        }
        return points_m.back();
    };
    Vec3 mean = Vec3::Zero();
    constexpr int n = 8;
    for (int k = -n; k <= n; ++k) mean += on(std::max(0.0, way_m + kRound_m * k / n)) / (2 * n + 1);
    Vec3 ahead = on(way_m + kRound_m) - on(std::max(0.0, way_m - kRound_m));
    mean.y() = ahead.y() = 0;
    return {mean, ahead.normalized()};
}

CreatureWalk::CreatureWalk(World& world, BodyId body, const Route& route, std::vector<Foothold> ground, const Def& def)
    : world_(&world), route_(route), ground_(std::move(ground)), def_(def) {
    const auto x = world.positions(body);
    double low = 1e9;
    for (const Vec3& p : x) low = std::min(low, p.y());
    const Route::Place start = route_.at(0);
    const Mat3 R = axes(start.ahead);
    for (const double front : {1.0, -1.0})
        for (const double side : {1.0, -1.0}) feet_.push_back({.home = Vec3::Zero(), .phase = front * side > 0 ? 0.0 : 0.5, .ties = {}, .from_m = Vec3::Zero(), .to_m = Vec3::Zero()});
    std::vector<std::vector<std::size_t>> soles(4);
    for (std::size_t v = 0; v < x.size(); ++v) {
        if (x[v].y() > low + def_.sole_m) continue;
        const Vec3 from = R.transpose() * (x[v] - start.at_m);
        soles[(from.x() > 0 ? 0u : 2u) + (from.z() > 0 ? 0u : 1u)].push_back(v);
    }
    for (std::size_t f = 0; f < 4; ++f) {
        Foot& foot = feet_[f];
        for (const std::size_t v : soles[f]) foot.home += R.transpose() * (x[v] - start.at_m) / double(soles[f].size());
        for (const std::size_t v : soles[f]) {
            AttachmentDef tie;
            tie.body = body;
            tie.vertices[0] = std::int32_t(v);
            tie.stiffness_n_m = def_.stiffness_n_m;
            foot.ties.push_back({world.attach(tie), R.transpose() * (x[v] - start.at_m) - foot.home});
        }
        foot.home.y() -= ground_m(start.at_m.x(), start.at_m.z());
        foot.from_m = foot.to_m = foothold(foot, 0);
    }
}

double CreatureWalk::ground_m(double x, double z) const {
    double y = kSky_m;
    for (int i = 0; i < 64; ++i) {
        double free_m = kSky_m;
        for (const Foothold& solid : ground_) {
            const auto& q = solid.pose.rotation_wxyz;
            const Mat3 R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
            free_m = std::min(free_m, contact::distance(solid.shape, R.transpose() * (Vec3(x, y, z) - solid.pose.position_m)).d);
        }
        if (free_m < 1e-4) break;
        y -= free_m;
    }
    return y;
}

Vec3 CreatureWalk::foothold(const Foot& foot, double way_m) const {
    const Route::Place place = route_.at(way_m);
    Vec3 at = place.at_m + axes(place.ahead) * Vec3(foot.home.x(), 0, foot.home.z());
    at.y() = ground_m(at.x(), at.z()) + foot.home.y();
    return at;
}

void CreatureWalk::place(const Foot& foot, const Vec3& middle, const Vec3& ahead) {
    // Half as steep as the ground: ankles.
    const Mat3 R = axes(ahead);
    const auto slope = [&](const Vec3& along) {
        const Vec3 a = middle + 0.02 * along, b = middle - 0.02 * along;
        return std::clamp((ground_m(a.x(), a.z()) - ground_m(b.x(), b.z())) / 0.04, -0.35, 0.35);
    };
    const double pitch = slope(R.col(0)), roll = slope(R.col(2));
    for (const Tie& tie : foot.ties) {
        Vec3 at = middle + R * tie.from_middle;
        at.y() += pitch * tie.from_middle.x() + roll * tie.from_middle.z();
        world_->move_attachment(tie.id, at);
    }
}

void CreatureWalk::before_step() {
    if (!walks()) return;
    const double h = world_->def().time_step_s;
    if (leap_s_ > 0) {
        // Evenly faster, all soles alike.
        leap_s_ += h;
        leapt_m_ = 0.5 * leap_s_ * leap_s_ / push_s_ * leap_m_s_;
        const Vec3 ahead = route_.at(way_m_).ahead;
        for (const Foot& foot : feet_)
            for (const Tie& tie : foot.ties) world_->move_attachment(tie.id, foot.to_m + axes(ahead) * tie.from_middle + leapt_m_);
        if (leap_s_ > push_s_) let_go();
        return;
    }
    time_s_ += h;
    if (!arrived()) way_m_ = std::min(route_.length_m(), way_m_ + h * def_.speed_m_s * smooth_step(0, 0.6, time_s_));
    const Vec3 ahead = route_.at(way_m_).ahead;
    for (Foot& foot : feet_) {
        double u = time_s_ / def_.period_s + foot.phase;
        u -= std::floor(u);
        const bool swings = u < 0.5;
        if (swings && !foot.swings) {
            // Where the body will be in the middle of the next stance: half a swing and half a stance ahead of the swing's end.
            foot.from_m = foot.to_m;
            foot.to_m = foothold(foot, std::min(route_.length_m(), way_m_ + 0.75 * def_.period_s * def_.speed_m_s));
        }
        foot.swings = swings;
        Vec3 middle = foot.to_m;
        if (swings) {
            const double s = smooth_step(0, 0.5, u), arc = std::sin(2 * M_PI * u);
            middle = foot.from_m + s * (foot.to_m - foot.from_m);
            const double moves = std::min(1.0, (foot.to_m - foot.from_m).norm() / 0.01);  // one that stays does not lift
            const double over = std::max({foot.from_m.y(), foot.to_m.y(), ground_m(middle.x(), middle.z()) + foot.home.y()});
            middle.y() = (1 - arc) * middle.y() + arc * (over + moves * def_.lift_m);
        }
        place(foot, middle, ahead);
    }
}

void CreatureWalk::leap(const Vec3& velocity_m_s, double push_s) {
    leap_m_s_ = velocity_m_s;
    push_s_ = push_s;
    leap_s_ = 1e-9;
}

void CreatureWalk::let_go() {
    for (const Foot& foot : feet_)
        for (const Tie& tie : foot.ties) world_->detach(tie.id);
    feet_.clear();
}

}  // namespace supple::demos
