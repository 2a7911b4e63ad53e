#pragma once
#include <vector>

#include "supple/world/world.h"

namespace supple {

/// A blade, a polyline, that goes evenly from one pose to another and cuts on its way.
struct CutEvent {
    BodyId body{};
    std::vector<Vec3> from_m, to_m;  ///< two points or more, as many in both; in the world
    double begin_s = 0, end_s = 0;   ///< end_s = begin_s: all at once
    double stride_m = 0;             ///< it cuts each time that it has gone so far, from one stride behind; 0: one and a half mean edges of the body
    CutDef def{};
};

/// A ball that goes evenly from one place to another and removes the elements whose centres it sweeps, where the body is then.
struct EraseEvent {
    BodyId body{};
    Vec3 from_m = Vec3::Zero(), to_m = Vec3::Zero();
    double radius_m = 0.01;          ///< > 0
    double begin_s = 0, end_s = 0;
};

/// Lips that are near one another are glued at a moment.
struct HealEvent {
    BodyId body{};
    HealDef def{};
    double time_s = 0;
};

/// Elements that are added at a moment, numbered as the body is then.
struct AddEvent {
    BodyId body{};
    AddedElements elements{};
    double time_s = 0;
};

/// Edits on a timeline. What happens before a step depends on the number of the step alone: a run that a snapshot continues is the same.
class EditScript {
public:
    EditScript() = default;
    /// @error Error(invalid_argument) naming the field
    EditScript(std::vector<CutEvent> cuts, std::vector<EraseEvent> erasures, std::vector<HealEvent> heals = {}, std::vector<AddEvent> additions = {});

    /// Call before each step. An erasure that would leave nothing leaves the body as it is.
    /// @return  edits made
    /// @error   as World::add_elements(), where what is to be added does not fit the body
    std::size_t before_step(World& world) const;

    const std::vector<CutEvent>& cuts() const { return cuts_; }
    const std::vector<EraseEvent>& erasures() const { return erasures_; }
    const std::vector<HealEvent>& heals() const { return heals_; }
    const std::vector<AddEvent>& additions() const { return additions_; }

private:
    std::vector<CutEvent> cuts_;
    std::vector<EraseEvent> erasures_;
    std::vector<HealEvent> heals_;
    std::vector<AddEvent> additions_;
};

/// Mean length of the edges of the elements at rest [m].
double mean_edge_m(const VolumeMesh& mesh);

/// Elements whose centres lie within radius_m of the segment a b, the body as it is now.
std::vector<std::int32_t> elements_near(const World& world, BodyId body, const Vec3& a_m, const Vec3& b_m, double radius_m);

}  // namespace supple
