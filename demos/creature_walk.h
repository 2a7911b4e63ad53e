#pragma once
#include <array>
#include <vector>

#include "supple/world/world.h"

namespace supple::demos {

/// A way on the ground that a walker is steered along.
struct Route {
    std::vector<Vec3> points_m;  ///< y is not looked at
    /// After `way_m` along it, corners rounded: place (y = 0) and direction (unit).
    struct Place {
        Vec3 at_m, ahead;
    };
    Place at(double way_m) const;
    double length_m() const;
};

/// A solid that feet are put on.
struct Foothold {
    Shape shape;
    Pose pose;
};

/// Makes a soft body walk: its soles are tied to places that step from foothold to foothold, diagonal pairs of feet in turn; all above them follows by elasticity.
/// It climbs what is in the way: footholds lie on the ground, which is given, not touched; what else the body meets on its way are contacts of the world.
class CreatureWalk {
public:
    struct Def {
        double speed_m_s = 0.22;
        double period_s = 0.40;        ///< of a foot: half of it in the air
        double lift_m = 0.030;         ///< of a swinging foot above the higher of its footholds
        double stiffness_n_m = 2500;   ///< of each tie
        double sole_m = 0.012;         ///< vertices up to so much above the lowest are sole
    };

    /// @param body  x to its nose, y up, in its start position with its soles on the ground
    CreatureWalk(World& world, BodyId body, const Route& route, std::vector<Foothold> ground, const Def& def);

    void before_step();            ///< moves the ties to where they are at the end of the step
    void let_go();                 ///< unties all feet
    bool walks() const { return !feet_.empty(); }
    bool arrived() const { return way_m_ >= route_.length_m(); }
    double way_m() const { return way_m_; }
    /// The soles fly off together with this velocity, reached evenly in `push_s`, and are let go at its end.
    void leap(const Vec3& velocity_m_s, double push_s);
    bool leaps() const { return leap_s_ > 0; }

private:
    struct Tie {
        AttachmentId id;
        Vec3 from_middle;  ///< of the sole, in the body's axes
    };
    struct Foot {
        Vec3 home = Vec3::Zero();  ///< middle of the sole in the body's axes, from the body's place on the route
        double phase = 0;  ///< 0 or 0.5
        std::vector<Tie> ties;
        Vec3 from_m = Vec3::Zero(), to_m = Vec3::Zero();  ///< footholds
        bool swings = false;
    };
    double ground_m(double x, double z) const;
    Vec3 foothold(const Foot& foot, double way_m) const;
    void place(const Foot& foot, const Vec3& middle, const Vec3& ahead);

    World* world_;
    Route route_;
    std::vector<Foothold> ground_;
    Def def_;
    std::vector<Foot> feet_;
    double way_m_ = 0, time_s_ = 0;
    Vec3 leap_m_s_ = Vec3::Zero(), leapt_m_ = Vec3::Zero();
    double leap_s_ = 0, push_s_ = 0;
};

}  // namespace supple::demos
