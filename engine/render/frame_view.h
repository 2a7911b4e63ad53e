#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple {

/// How a surface looks where no scalar is mapped.
enum class Look { tissue, rubber, gel, metal };

/// One triangle surface of a frame. Spans are borrowed until draw() returns.
struct SurfaceView {
    std::span<const Vec3> positions;                     ///< per vertex [m]; vertices of no triangle are skipped
    std::span<const Triangle> triangles;                 ///< outward counter-clockwise
    std::span<const double> scalar;                      ///< per vertex, e.g. von Mises [Pa]; empty = plain material
    std::span<const std::array<std::int32_t, 2>> edges;  ///< wireframe lines; empty = none
    std::span<const Vec3> rest_positions;                ///< drawn as a faint outline (with edges); empty = none
    Look look = Look::tissue;
    double crease_angle_deg = 40;                        ///< normals are smooth across edges below it, crisp above
};

struct ArrowView {   ///< a force
    Vec3 from_m, to_m;
    std::array<float, 3> color{1.0f, 0.85f, 0.2f};
};

struct MarkerView {  ///< a tool or a picking cursor
    Vec3 centre_m;
    double radius_m;
    std::array<float, 3> color{0.95f, 0.95f, 1.0f};
};

struct ColorScale {
    std::string map = "viridis";   ///< any of color_map_names()
    double low = 0, high = 1;      ///< low < high; values outside take the end colours
    std::string title = "von Mises";
    std::string unit = "Pa";       ///< prefixes k, M, G are chosen by the legend
};

struct Camera {
    Vec3 eye_m = Vec3(0.2, 0.1, 0.8);
    Vec3 target_m = Vec3::Zero();
    Vec3 up = Vec3(0, 1, 0);
    double fov_deg = 40;           ///< vertical, 1..170
};

/// Everything that one picture shows. The renderer reads nothing else: no World, no file.
struct FrameView {
    std::vector<SurfaceView> surfaces;
    std::vector<ArrowView> arrows;
    std::vector<MarkerView> markers;
    std::optional<ColorScale> scale;      ///< legend, if any surface has a scalar
    std::optional<double> ground_height_m;  ///< along `camera.up`; catches the shadow
    Camera camera;
    std::string caption;                  ///< large, lower left; empty = none
    std::string hud;                      ///< one small line, top left; empty = none
};

}  // namespace supple
