#include "supple/world/prepared_loads.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "supple/base/error.h"
#include "supple/math/polar.h"
#include "supple/world/template_data.h"

namespace supple {

namespace {

constexpr std::size_t kVertexChunk = 512;

[[noreturn]] void refuse(const std::string& where, const std::string& message) { throw Error(ErrorCode::invalid_argument, where, message); }

bool finite(const Vec3& v) { return v.allFinite(); }
bool finite(const Mat34& v) { return v.allFinite(); }
bool finite(double v) { return std::isfinite(v); }

template <class T>
void check(const Timeline<T>& line, const std::string& where) {
    if (line.values.empty()) refuse(where, "has no value");
    if (!line.times_s.empty() && line.times_s.size() != line.values.size()) {
        refuse(where, "has " + std::to_string(line.times_s.size()) + " times and " + std::to_string(line.values.size()) + " values; give as many of each");
    }
    for (std::size_t i = 0; i < line.times_s.size(); ++i) {
        if (!std::isfinite(line.times_s[i]) || (i > 0 && !(line.times_s[i] > line.times_s[i - 1]))) refuse(where, "times_s must be finite and ascending");
    }
    for (const T& value : line.values) {
        if (!finite(value)) refuse(where, "has a value that is not finite");
    }
}

/// Half the cross product of two edges: area times outward normal.
Vec3 area_vector(const Triangle& t, const std::vector<Vec3>& x) {
    const Vec3& a = x[std::size_t(t[0])];
    return 0.5 * (x[std::size_t(t[1])] - a).cross(x[std::size_t(t[2])] - a);
}

/// Where a load acts: its vertices, and the boundary triangles among them.
struct Site {
    std::vector<std::int32_t> vertices;
    std::vector<Triangle> triangles;
};

Site find_site(const TemplateData& data, const std::string& name, const Load& load) {
    Site site;
    if (!load.triangles.empty()) {
        if (load.kind != LoadKind::traction && load.kind != LoadKind::pressure && load.kind != LoadKind::moment) {
            refuse("Load.triangles", "belongs to tractions, pressures and moments; give Load.where instead");
        }
        std::vector<std::int32_t> chosen = load.triangles;
        std::sort(chosen.begin(), chosen.end());
        chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
        for (const std::int32_t t : chosen) {
            if (t < 0 || std::size_t(t) >= data.boundary.triangles.size()) {
                refuse("Load.triangles", std::to_string(t) + " is no boundary triangle of \"" + name + "\"; it has " +
                                             std::to_string(data.boundary.triangles.size()) + ", counted from 0");
            }
            site.triangles.push_back(data.boundary.triangles[std::size_t(t)]);
            site.vertices.insert(site.vertices.end(), site.triangles.back().begin(), site.triangles.back().end());
        }
        std::sort(site.vertices.begin(), site.vertices.end());
        site.vertices.erase(std::unique(site.vertices.begin(), site.vertices.end()), site.vertices.end());
        return site;
    }
    site.vertices = select_some(data, name, load.where, "Load.where");
    std::vector<bool> in(data.mesh.vertices.size(), false);
    for (const std::int32_t v : site.vertices) in[std::size_t(v)] = true;
    for (const Triangle& t : data.boundary.triangles) {
        if (in[std::size_t(t[0])] && in[std::size_t(t[1])] && in[std::size_t(t[2])]) site.triangles.push_back(t);
    }
    return site;
}

void require_triangles(const Site& site, const std::string& name) {
    if (site.triangles.empty()) refuse("Load.where", "no boundary triangle of \"" + name + "\" has its three vertices selected");
}

/// A third of the area of the site's triangles to each of their vertices [m^2].
std::vector<double> area_shares(const TemplateData& data, const Site& site) {
    std::vector<double> share(data.mesh.vertices.size(), 0.0);
    for (const Triangle& t : site.triangles) {
        const double third = area_vector(t, data.mesh.vertices).norm() / 3;
        for (const std::int32_t v : t) share[std::size_t(v)] += third;
    }
    return share;
}

DeadLoad make_dead(const TemplateData& data, const std::string& name, const Load& load) {
    const Site site = find_site(data, name, load);
    std::vector<double> weight(data.mesh.vertices.size(), 0.0);
    if (load.kind == LoadKind::total_force || load.kind == LoadKind::force_per_vertex) {
        const double share = load.kind == LoadKind::total_force ? 1.0 / double(site.vertices.size()) : 1.0;
        for (const std::int32_t v : site.vertices) weight[std::size_t(v)] = share;
    } else if (load.kind == LoadKind::traction) {
        require_triangles(site, name);
        weight = area_shares(data, site);
    } else {
        const std::vector<std::int32_t> elements = select_elements(data.mesh, load.where);
        if (elements.empty()) refuse("Load.where", "no element of \"" + name + "\" has all its vertices selected");
        double share[8];
        for (const std::int32_t e : elements) {
            const std::size_t corners = fem::corner_volumes(data.mesh, std::size_t(e), share);
            for (std::size_t a = 0; a < corners; ++a) weight[std::size_t(element_vertices(data.mesh, std::size_t(e))[a])] += share[a];
        }
    }
    DeadLoad dead;
    dead.value = load.value;
    for (std::size_t v = 0; v < weight.size(); ++v) {
        if (weight[v] == 0) continue;
        dead.vertex.push_back(std::int32_t(v));
        dead.weight.push_back(weight[v]);
    }
    return dead;
}

/// Matrix block of two vertices; the corners of a boundary face share an element, so it is there.
std::int32_t find_block(const TemplateData& data, std::int32_t vertex, std::int32_t other) {
    return std::int32_t(data.pattern.block(std::size_t(data.pattern.row[std::size_t(vertex)]), data.pattern.row[std::size_t(other)]));
}

PressureLoad make_pressure(const TemplateData& data, const std::string& name, const Load& load) {
    const Site site = find_site(data, name, load);
    require_triangles(site, name);
    std::vector<std::vector<Triangle>> around(data.mesh.vertices.size());
    for (const Triangle& t : site.triangles) {
        for (const std::int32_t v : t) around[std::size_t(v)].push_back(t);
    }
    PressureLoad pressure;
    pressure.follower = load.follower;
    pressure.amount = load.amount;
    pressure.start.push_back(0);
    for (std::size_t v = 0; v < around.size(); ++v) {
        if (around[v].empty()) continue;
        Vec3 inwards = Vec3::Zero();
        for (const Triangle& t : around[v]) inwards -= area_vector(t, data.mesh.vertices) / 3;
        pressure.vertex.push_back(std::int32_t(v));
        pressure.area.push_back(inwards);
        pressure.triangle.insert(pressure.triangle.end(), around[v].begin(), around[v].end());
        pressure.start.push_back(std::int32_t(pressure.triangle.size()));
    }
    if (!load.follower) return pressure;
    pressure.face = site.triangles;
    for (const Triangle& t : site.triangles) {
        std::array<std::int32_t, 6> blocks{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t i = t[k], j = t[(k + 1) % 3];
            blocks[2 * k] = find_block(data, i, j);
            blocks[2 * k + 1] = find_block(data, j, i);
        }
        pressure.block.push_back(blocks);
    }
    return pressure;
}

/// Stiffness -df_i/dx_j between two corners of a triangle under unit pressure, made symmetric; k is the third. The force on each corner is -N/6 with
/// N = a x b + b x c + c x a, so that df_i/dx_j = -[e_j]/6, e_j the edge opposite to j, for all i; symmetric ([e_j] - [e_i])/12, nothing on the diagonal.
Vec3 pressure_stiffness_axis(const std::vector<Vec3>& x, std::int32_t i, std::int32_t j, std::int32_t k) {
    return (x[std::size_t(i)] + x[std::size_t(j)] - 2 * x[std::size_t(k)]) / 12;
}

Vec3 sample_point(const std::array<std::int32_t, 2>& ends, const std::vector<Vec3>& x) {
    return 0.5 * (x[std::size_t(ends[0])] + x[std::size_t(ends[1])]);
}

Vec3 mean_of(const MomentLoad& load, const std::vector<Vec3>& x) {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < load.sample.size(); ++i) mean += load.weight[i] * sample_point(load.sample[i], x);
    return mean;
}

/// sum w (|r|^2 I - r r^T): the torque of the forces w omega x r is this times omega.
Mat3 inertia_of(const MomentLoad& load, const std::vector<Vec3>& x, const Vec3& mean) {
    Mat3 inertia = Mat3::Zero();
    for (std::size_t i = 0; i < load.sample.size(); ++i) {
        const Vec3 r = sample_point(load.sample[i], x) - mean;
        inertia += load.weight[i] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    return inertia;
}

MomentLoad make_moment(const TemplateData& data, const std::string& name, const Load& load) {
    if (!load.axis.allFinite() || !(load.axis.norm() > 0)) refuse("Load.axis", "must be a direction of some length; a moment turns about it");
    const Site site = find_site(data, name, load);
    const std::vector<Vec3>& X = data.mesh.vertices;
    MomentLoad moment;
    moment.follower = load.follower;
    moment.amount = load.amount;
    moment.axis = load.axis.normalized();
    for (const Triangle& t : site.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            moment.sample.push_back({t[k], t[(k + 1) % 3]});
            moment.weight.push_back(area_vector(t, X).norm());
        }
    }
    if (site.triangles.empty()) {
        for (const std::int32_t v : site.vertices) {
            moment.sample.push_back({v, v});
            moment.weight.push_back(1);
        }
    }
    double total = 0;
    for (const double w : moment.weight) total += w;
    for (double& w : moment.weight) w /= total;
    const Vec3 mean = mean_of(moment, X);
    for (const auto& ends : moment.sample) moment.arm.push_back(sample_point(ends, X) - mean);
    const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(inertia_of(moment, X, mean), Eigen::EigenvaluesOnly).eigenvalues();
    if (!(spread[0] > 1e-9 * spread[2])) {
        refuse("Load.where", "the selected vertices of \"" + name + "\" lie on a line, which no forces can turn about itself; select at least three that do not");
    }
    return moment;
}

/// The rotation that fits the selection best: polar factor of sum w x r^T.
Mat3 rotation_of(const MomentLoad& load, const std::vector<Vec3>& x) {
    Mat3 fit = Mat3::Zero();
    for (std::size_t i = 0; i < load.sample.size(); ++i) fit += load.weight[i] * sample_point(load.sample[i], x) * load.arm[i].transpose();
    return rotation_matrix(polar_quaternion(fit));  // unique for a flat selection too: det R = +1
}

void add_moment(const MomentLoad& load, double amount, const std::vector<Vec3>& x, std::vector<Vec3>& f) {
    const Vec3 mean = mean_of(load, x);
    const Vec3 torque = amount * (load.follower ? Vec3(rotation_of(load, x) * load.axis) : load.axis);
    const Eigen::SelfAdjointEigenSolver<Mat3> spread(inertia_of(load, x, mean));
    Vec3 omega = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {  // a selection that has collapsed to a line carries no torque about it
        const Vec3 direction = spread.eigenvectors().col(k);
        if (spread.eigenvalues()[k] > 1e-9 * spread.eigenvalues()[2]) omega += direction * (direction.dot(torque) / spread.eigenvalues()[k]);
    }
    for (std::size_t i = 0; i < load.sample.size(); ++i) {
        const Vec3 half = 0.5 * load.weight[i] * omega.cross(sample_point(load.sample[i], x) - mean);
        for (const std::int32_t v : load.sample[i]) f[std::size_t(v)] += half;
    }
}

}  // namespace

void check_timeline(const Timeline<Vec3>& line, const std::string& where) { check(line, where); }
void check_timeline(const Timeline<Mat34>& line, const std::string& where) { check(line, where); }
void check_timeline(const Timeline<double>& line, const std::string& where) { check(line, where); }

std::vector<std::int32_t> select_some(const TemplateData& data, const std::string& body_name, const Selection& where, const char* what) {
    std::vector<std::int32_t> vertices = select_vertices(data.mesh, where);
    if (vertices.empty()) {
        auto text = [](const Vec3& p) { return "(" + to_text(p.x()) + ", " + to_text(p.y()) + ", " + to_text(p.z()) + ")"; };
        refuse(what, "the selection holds no vertex of \"" + body_name + "\"; its rest shape spans " + text(data.min_m) + " to " +
                         text(data.max_m) + " m");
    }
    return vertices;
}

void PreparedLoads::add(const TemplateData& data, const std::string& body_name, const Load& load) {
    const bool vector_valued = load.kind != LoadKind::pressure && load.kind != LoadKind::moment;
    if (vector_valued) {
        check(load.value, "Load.value");
        if (!load.amount.values.empty()) refuse("Load.amount", "belongs to pressures and moments; this kind of load has a Load.value");
        dead_.push_back(make_dead(data, body_name, load));
        dead_.back().definition = load;
        return;
    }
    check(load.amount, "Load.amount");
    if (!load.value.values.empty()) refuse("Load.value", "does not belong to a pressure or a moment; give Load.amount");
    if (load.kind == LoadKind::pressure) {
        pressure_.push_back(make_pressure(data, body_name, load));
        pressure_.back().definition = load;
        followers_ = followers_ || load.follower;
    } else {
        moment_.push_back(make_moment(data, body_name, load));
        moment_.back().definition = load;
        followers_ = true;
    }
}

void PreparedLoads::clear() { *this = {}; }

void PreparedLoads::add_dead(double time_s, std::vector<Vec3>& f) const {
    for (const DeadLoad& load : dead_) {
        const Vec3 value = load.value.at(time_s);
        for (std::size_t i = 0; i < load.vertex.size(); ++i) f[std::size_t(load.vertex[i])] += load.weight[i] * value;
    }
    for (const PressureLoad& load : pressure_) {
        if (load.follower) continue;
        const double amount = load.amount.at(time_s);
        for (std::size_t i = 0; i < load.vertex.size(); ++i) f[std::size_t(load.vertex[i])] += amount * load.area[i];
    }
}

void PreparedLoads::add_followers(Team& team, double time_s, const std::vector<Vec3>& x, std::vector<Vec3>& f) const {
    for (const PressureLoad& load : pressure_) {
        if (!load.follower) continue;
        const double third = load.amount.at(time_s) / 3;
        team.for_range(load.vertex.size(), kVertexChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                Vec3 area = Vec3::Zero();
                for (std::int32_t t = load.start[i]; t < load.start[i + 1]; ++t) area += area_vector(load.triangle[std::size_t(t)], x);
                f[std::size_t(load.vertex[i])] -= third * area;
            }
        });
    }
    for (const MomentLoad& load : moment_) add_moment(load, load.amount.at(time_s), x, f);
}

bool PreparedLoads::any_follower_pressure() const {
    return std::any_of(pressure_.begin(), pressure_.end(), [](const PressureLoad& load) { return load.follower; });
}

template <class Real>
void PreparedLoads::add_stiffness(double time_s, const std::vector<Vec3>& x, double scale, Real* value) const {
    for (const PressureLoad& load : pressure_) {
        const double amount = scale * load.amount.at(time_s);
        for (std::size_t t = 0; t < load.face.size(); ++t) {
            const Triangle& f = load.face[t];
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 a = amount * pressure_stiffness_axis(x, f[k], f[(k + 1) % 3], f[(k + 2) % 3]);
                for (const bool mirrored : {false, true}) {  // (j, i) is the transpose of (i, j): the other sign
                    Real* block = value + std::size_t(load.block[t][2 * k + std::size_t(mirrored)]) * 12;
                    const Vec3 w = mirrored ? Vec3(-a) : a;  // [w] d = w x d; columns of four
                    block[1] += Real(w.z()), block[2] -= Real(w.y());
                    block[4] -= Real(w.z()), block[6] += Real(w.x());
                    block[8] += Real(w.y()), block[9] -= Real(w.x());
                }
            }
        }
    }
}
template void PreparedLoads::add_stiffness(double, const std::vector<Vec3>&, double, float*) const;
template void PreparedLoads::add_stiffness(double, const std::vector<Vec3>&, double, double*) const;

void PreparedLoads::add_stiffness_product(double time_s, const std::vector<Vec3>& x, const std::vector<Vec3>& field, std::vector<Vec3>& out) const {
    for (const PressureLoad& load : pressure_) {
        const double amount = load.amount.at(time_s);
        for (const Triangle& f : load.face) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t i = f[k], j = f[(k + 1) % 3];
                const Vec3 a = amount * pressure_stiffness_axis(x, i, j, f[(k + 2) % 3]);
                out[std::size_t(i)] += a.cross(field[std::size_t(j)]);
                out[std::size_t(j)] -= a.cross(field[std::size_t(i)]);
            }
        }
    }
}

double PreparedLoads::dead_potential_j(double time_s, const std::vector<Vec3>& x, const std::vector<Vec3>& start) const {
    double work = 0;
    for (const DeadLoad& load : dead_) {
        const Vec3 value = load.value.at(time_s);
        for (std::size_t i = 0; i < load.vertex.size(); ++i) {
            const std::size_t v = std::size_t(load.vertex[i]);
            work += load.weight[i] * value.dot(x[v] - start[v]);
        }
    }
    for (const PressureLoad& load : pressure_) {
        if (load.follower) continue;
        const double amount = load.amount.at(time_s);
        for (std::size_t i = 0; i < load.vertex.size(); ++i) {
            const std::size_t v = std::size_t(load.vertex[i]);
            work += amount * load.area[i].dot(x[v] - start[v]);
        }
    }
    return -work;
}

}  // namespace supple
