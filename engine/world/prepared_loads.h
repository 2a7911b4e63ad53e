#pragma once
#include <vector>

#include "supple/base/parallel.h"
#include "supple/mesh/mesh_edit.h"
#include "supple/world/loads.h"

namespace supple {

struct TemplateData;

/// A dead load made ready: force on vertex[i] = weight[i] * value(t).
struct DeadLoad {
    std::vector<std::int32_t> vertex;
    std::vector<double> weight;
    Timeline<Vec3> value;
    Load definition;
};

/// A pressure made ready. Dead: force on vertex[i] = area[i] * p(t). Follower: the triangles around each vertex.
struct PressureLoad {
    bool follower = true;
    std::vector<std::int32_t> vertex;
    std::vector<Vec3> area;              ///< a third of the rest areas around the vertex, pointing inwards [m^2]
    std::vector<std::int32_t> start;     ///< [vertex + 1] ranges of `triangle`
    std::vector<Triangle> triangle;
    std::vector<Triangle> face;          ///< follower: each triangle once,
    std::vector<std::array<std::int32_t, 6>> block;  ///< and its matrix blocks ab ba bc cb ca ac
    Timeline<double> amount;
    Load definition;
};

/// A moment made ready: it acts on sample points, each half way between two vertices, which take half of its force each. The middles of the
/// edges of a triangle, a third of its area each, integrate products of linear functions exactly. A lone vertex is both ends of its sample.
struct MomentLoad {
    bool follower = true;
    std::vector<std::array<std::int32_t, 2>> sample;
    std::vector<double> weight;          ///< sums to one
    std::vector<Vec3> arm;               ///< rest position from the weighted mean [m]
    Vec3 axis = Vec3::Zero();            ///< unit length
    Timeline<double> amount;
    Load definition;
};

/// The loads of one body.
class PreparedLoads {
public:
    /// @error Error(invalid_argument) naming the field of Load
    void add(const TemplateData& data, const std::string& body_name, const Load& load);
    void clear();

    /// The loads after an edit of the mesh. Forces on vertices go to their copies in equal parts, and vanish with what was removed; tractions, pressures and moments stay on what is
    /// left of their triangles and act on nothing that was laid open; body forces stay with their elements.
    PreparedLoads followed(const TemplateData& before, const TemplateData& after, const TopologyDelta& delta, const std::string& body_name) const;
    std::vector<DeadLoad>& dead() { return dead_; }
    const std::vector<DeadLoad>& dead() const { return dead_; }

    /// Adds the loads that do not follow the body to f.
    void add_dead(double time_s, std::vector<Vec3>& f) const;
    bool any_follower() const { return followers_; }
    /// Adds the others, with the body at x. Sums vertex by vertex: any number of threads gives the same bits.
    void add_followers(Team& team, double time_s, const std::vector<Vec3>& x, std::vector<Vec3>& f) const;
    /// The stiffness of pressures that follow the body, -df/dx, with the body at x: its symmetric part, which is all of it where the pressure acts on a closed surface, or on one whose
    /// edge is held or slides in planes of symmetry. Indefinite. `value`: matrix blocks, [block][column][x y z 0].
    bool any_follower_pressure() const;
    template <class Real>
    void add_stiffness(double time_s, const std::vector<Vec3>& x, double scale, Real* value) const;
    void add_stiffness_product(double time_s, const std::vector<Vec3>& x, const std::vector<Vec3>& field, std::vector<Vec3>& out) const;
    /// -sum f.(x - start) of the dead loads [J].
    double dead_potential_j(double time_s, const std::vector<Vec3>& x, const std::vector<Vec3>& start) const;

private:
    std::vector<DeadLoad> dead_;
    std::vector<PressureLoad> pressure_;
    std::vector<MomentLoad> moment_;
    bool followers_ = false;
};

/// @error Error(invalid_argument) at `where` unless times ascend, there are as many as values (or none), and all is finite
void check_timeline(const Timeline<Vec3>& line, const std::string& where);
void check_timeline(const Timeline<Mat34>& line, const std::string& where);
void check_timeline(const Timeline<double>& line, const std::string& where);

/// Vertices of a selection; none is an Error that says where the body lies.
std::vector<std::int32_t> select_some(const TemplateData& data, const std::string& body_name, const Selection& where, const char* what);

}  // namespace supple
