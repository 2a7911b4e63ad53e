#include "frame_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "framing.h"
#include "supple/io/report.h"

namespace supple::demos {
namespace {

double round_up(double value) {
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (value <= step * decade) return step * decade;
    return 10 * decade;
}

std::string number_text(const Reading& reading) {
    char text[64];
    if (reading.unit.empty()) std::snprintf(text, sizeof text, "%.0f", reading.value);
    else if (reading.unit == "%") std::snprintf(text, sizeof text, "%.0f %%", reading.value);
    else std::snprintf(text, sizeof text, "%.2f %s", reading.value, reading.unit.c_str());
    return text;
}

/// Room below the bodies for what hangs and swings.
double ground_below(const World& world) {
    const SceneBounds bounds = bounds_of(world);
    const Vec3 up = up_direction(world);
    const double low = std::min(up.dot(bounds.min_m), up.dot(bounds.max_m));
    return low - 0.45 * (bounds.max_m - bounds.min_m).norm();
}

/// Volume-weighted mean of Young's modulus around each vertex [Pa].
std::vector<double> vertex_stiffness(const World& world, BodyId body) {
    const VolumeMesh& mesh = world.shape(body).mesh();
    const auto young = world.element_young_pa(body);
    std::vector<double> sum(mesh.vertices.size(), 0.0), weight(mesh.vertices.size(), 0.0);
    const auto add = [&](std::size_t element, const auto& corners, double volume) {
        for (const std::int32_t v : corners) {
            sum[std::size_t(v)] += volume * young[element];
            weight[std::size_t(v)] += volume;
        }
    };
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
        const Tet& t = mesh.tets[e];
        const auto X = [&](std::size_t a) { return mesh.vertices[std::size_t(t[a])]; };
        add(e, t, tet_volume(X(0), X(1), X(2), X(3)));
    }
    for (std::size_t e = 0; e < mesh.hexes.size(); ++e) add(mesh.tets.size() + e, mesh.hexes[e], 1.0);
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0 ? sum[v] / weight[v] : 0.0;
    return sum;
}

}  // namespace

double StressRange::update(std::vector<double> stresses_pa, double elapsed_s) {
    constexpr double kPatience_s = 2.0;
    const double wanted = std::max(io::percentile(std::move(stresses_pa), 0.99), 1e-6);
    const double rounded = round_up(wanted);
    if (rounded > high_pa_) {
        high_pa_ = rounded;
        too_high_s_ = 0;
    } else if (wanted < 0.3 * high_pa_) {
        too_high_s_ += elapsed_s;
        if (too_high_s_ > kPatience_s) {
            high_pa_ = rounded;
            too_high_s_ = 0;
        }
    } else {
        too_high_s_ = 0;
    }
    return high_pa_;
}

FrameBuilder::FrameBuilder(Show& show, FrameOptions options)
    : show_(&show), options_(std::move(options)), ground_m_(ground_below(show.world())) {
    const SceneBounds bounds = bounds_of(show.world());
    size_m_ = (bounds.max_m - bounds.min_m).norm();
    centre_ = 0.5 * (bounds.min_m + bounds.max_m);
}

std::span<const double> FrameBuilder::on_surface(std::size_t b, const Skin* skin, std::span<const double> per_vertex) {
    if (skin == nullptr) return per_vertex;
    on_skin_[b].resize(skin->embedding().size());
    skin->embedding().interpolate(per_vertex, on_skin_[b]);
    return on_skin_[b];
}

/// What edits laid open, of the surface that is drawn.
std::span<const char> FrameBuilder::inner_of(BodyId body, const Skin* skin) {
    const World& world = show_->world();
    Inner& known = inner_[(std::uint64_t(body.generation) << 32) | body.index];
    const std::uint64_t edits = world.edit_count(body);
    if (known.edits == edits && known.skin == skin) return known.of_triangle;
    known = {edits, skin, {}};
    if (skin == nullptr) {
        known.of_triangle = world.inner_boundary(body);
    } else if (skin->inner_triangles() > 0) {
        for (std::size_t t = 0; t < skin->surface().triangles.size(); ++t) known.of_triangle.push_back(char(skin->is_inner(t)));
    }
    return known.of_triangle;
}

/// The skin where there is one: what the simulation moves, not what it computes on. A wireframe shows that instead.
SurfaceView FrameBuilder::make_surface(std::size_t b, const Skin* skin) {
    const BodyTemplate& shape = show_->world().shape(show_->world().bodies()[b]);
    SurfaceView surface;
    if (skin != nullptr) {
        skin_[b].resize(skin->embedding().size());
        skin->embedding().deform(positions_[b], skin_[b]);
        surface.positions = skin_[b];
        surface.triangles = skin->surface().triangles;
        surface.reference_positions = skin->surface().vertices;
    } else {
        surface.positions = positions_[b];
        surface.triangles = shape.boundary().triangles;
        surface.reference_positions = shape.mesh().vertices;
    }
    surface.inner = inner_of(show_->world().bodies()[b], skin);
    if (options_.wireframe) surface.edges = shape.boundary().edges;
    if (options_.opacity) surface.opacity = *options_.opacity;
    return surface;
}

void FrameBuilder::add_stress(std::size_t b, const Skin* skin, SurfaceView& surface, std::vector<double>& stresses) {
    const World& world = show_->world();
    const BodyId body = world.bodies()[b];
    if (options_.stress_at == FrameOptions::At::vertex) {
        surface.scalar = on_surface(b, skin, world.von_mises(body));
        stresses.insert(stresses.end(), surface.scalar.begin(), surface.scalar.end());
        return;
    }
    const std::span<const double> elements = world.element_von_mises(body);
    stresses.insert(stresses.end(), elements.begin(), elements.end());
    if (options_.stress_at == FrameOptions::At::element) {
        flat_[b].clear();
        if (skin != nullptr) {
            for (const Triangle& t : skin->surface().triangles) flat_[b].push_back(elements[std::size_t(skin->embedding().elements()[std::size_t(t[0])])]);
        } else {
            for (const std::int32_t e : world.shape(body).boundary().element) flat_[b].push_back(elements[std::size_t(e)]);
        }
        surface.triangle_scalar = flat_[b];
        return;
    }
    centres_[b].clear();
    const auto add_centre = [&](const auto& element) {
        Vec3 centre = Vec3::Zero();
        for (const std::int32_t v : element) centre += positions_[b][std::size_t(v)] / double(element.size());
        centres_[b].push_back(centre);
    };
    for (const Tet& t : world.shape(body).mesh().tets) add_centre(t);
    for (const Hex& h : world.shape(body).mesh().hexes) add_centre(h);
    view_.points.push_back({centres_[b], elements, 6});
    if (!options_.opacity) surface.opacity = 0.25;
    surface.look = Look::rubber;
    surface.color = {0.80f, 0.82f, 0.85f};  // glass: the colours of the points stay what they are
}

FrameView& FrameBuilder::build(double alpha, const std::string& hud, double elapsed_s) {
    const World& world = show_->world();
    const std::vector<BodyId> bodies = world.bodies();
    view_ = FrameView{};
    for (auto* lists : {&positions_, &centres_, &skin_}) lists->resize(bodies.size());
    for (auto* lists : {&flat_, &stiffness_, &on_skin_}) lists->resize(bodies.size());
    const ColorBy by = options_.color_by.value_or(show_->color_by());
    std::vector<double> stresses;
    double stiffest = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto now = world.positions(bodies[b]), before = world.previous_positions(bodies[b]);
        positions_[b].resize(now.size());
        for (std::size_t v = 0; v < now.size(); ++v) positions_[b][v] = (1 - alpha) * before[v] + alpha * now[v];

        const std::shared_ptr<const Skin> held = world.skin(bodies[b]);
        const Skin* skin = options_.wireframe ? nullptr : held.get();
        SurfaceView surface = make_surface(b, skin);
        if (by == ColorBy::stress) add_stress(b, skin, surface, stresses);
        if (by == ColorBy::stiffness) {
            stiffness_[b] = vertex_stiffness(world, bodies[b]);
            surface.scalar = on_surface(b, skin, stiffness_[b]);
            for (const double young : stiffness_[b]) stiffest = std::max(stiffest, young);
        }
        view_.surfaces.push_back(surface);
    }
    if (by == ColorBy::stress && !stresses.empty()) {
        view_.scale = ColorScale{};
        if (!options_.range_pa) view_.scale->high = range_.update(std::move(stresses), elapsed_s);
    }
    if (by == ColorBy::stiffness && stiffest > 0) {
        view_.scale = ColorScale{};
        view_.scale->high = round_up(stiffest * (1 - 1e-9));  // a round number stays itself
        view_.scale->title = "Young's modulus";
    }
    view_.ground_height_m = ground_m_;
    colliders_.add(world, alpha, up_direction(world), size_m_, centre_, view_);
    if (options_.contacts) {
        double weight_n = 0;
        for (const BodyId body : bodies)
            for (const double m : world.masses(body)) weight_n += m * world.def().gravity_m_s2.norm();
        add_contact_arrows(world, 4 * size_m_ / std::max(weight_n, 1e-3), view_);  // a tenth of the weight is as long as 0.4 of the scene
    }
    view_.hud = hud;
    if (!hud.empty())
        for (const Reading& reading : show_->readings()) view_.hud += "   " + reading.name + " " + number_text(reading);
    const std::optional<ColorScale> automatic = view_.scale;
    show_->decorate(view_);
    if (view_.scale && automatic && options_.automatic_range) view_.scale = automatic;
    if (view_.scale) view_.scale->map = options_.map;
    if (view_.scale && options_.range_pa) {
        view_.scale->low = (*options_.range_pa)[0];
        view_.scale->high = (*options_.range_pa)[1];
    }
    return view_;
}

}  // namespace supple::demos
