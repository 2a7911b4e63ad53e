#include "supple/render/renderer.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "supple/base/error.h"
#include "supple/render/annotations.h"
#include "supple/render/camera.h"
#include "supple/render/color_map.h"
#include "supple/render/point_buffers.h"
#include "supple/render/shapes.h"
#include "supple/render/stage.h"
#include "supple/render/surface_buffers.h"
#include "supple/render/targets.h"

namespace supple {

using namespace render;
using Eigen::Vector3f;
using Eigen::Vector4f;

namespace {

// Texture units, the same for every program.
constexpr int kShadowUnit = 0, kColorUnit = 1, kGroundUnit = 2, kOcclusionUnit = 3, kSceneUnit = 4, kNoiseUnit = 5, kValuesUnit = 6, kUnits = 7;

Vector3f linear_of(const std::array<float, 3>& srgb) {
    const auto one = [](float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); };
    return {one(srgb[0]), one(srgb[1]), one(srgb[2])};
}

Vector3f default_color(Look look) {  // linear
    switch (look) {
        case Look::tissue:
            return {0.235f, 0.036f, 0.026f};
        case Look::rubber:
            return {0.055f, 0.135f, 0.215f};
        case Look::gel:
            return {0.09f, 0.42f, 0.46f};
        case Look::metal:
            return {0.56f, 0.57f, 0.58f};
    }
    return {0.5f, 0.5f, 0.5f};
}

/// What a cut shows, linear: flesh is lighter and pinker than its capsule; rubber, gel and metal are the same all through, freshly cut.
Vector3f inner_color(Look look, const Vector3f& outside) {
    if (look == Look::tissue) return {0.42f, 0.115f, 0.088f};
    return outside + 0.25f * (Vector3f::Ones() - outside);
}

/// Whichever caller's colour or position: a picture is no place for surprises.
void require_finite(const Vec3& p, const std::string& where) {
    if (!p.allFinite()) throw Error(ErrorCode::invalid_argument, where, "is not finite");
}

void require_legal(const RendererDef& def, int most_samples, int largest) {
    const int size_limit = std::min(largest, 16384);
    require_in_range(def.width, 16, size_limit, "RendererDef.width");
    require_in_range(def.height, 16, size_limit, "RendererDef.height");
    if (def.samples != 0)
        require_in_range(def.samples, 2, most_samples, "RendererDef.samples", "or 0 for none; the driver sets the upper limit");
    require_in_range(def.shadow_map_size, 128, 8192, "RendererDef.shadow_map_size");
    if (!std::has_single_bit(unsigned(def.shadow_map_size)))
        throw Error(ErrorCode::invalid_argument, "RendererDef.shadow_map_size",
                    std::to_string(def.shadow_map_size) + " is not a power of two; 1024 is a good one");
}

void require_context() {
    // epoxy ends the process if asked for a function without any context; its version query is the one safe question.
    if (epoxy_gl_version() < 33 || !epoxy_is_desktop_gl())
        throw Error(ErrorCode::no_display, "Renderer",
                    "needs a current context of OpenGL 3.3 or later, core profile: make a HeadlessContext first");
}

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

struct Renderer::Impl {
    RendererDef def;
    std::optional<Targets> targets;
    std::optional<ShadowTargets> shadow;
    std::map<std::string, Program> surface_programs;  // by their defines
    Program depth_program{"depth.vert", "depth.frag"};
    Program ground_mask_program{"fullscreen.vert", "ground_mask.frag"};
    Program ground_soften_program{"fullscreen.vert", "ground_soften.frag"};
    Program backdrop_program{"fullscreen.vert", "studio.frag"};
    Program ground_program{"fullscreen.vert", "studio.frag", "GROUND"};
    Program composite_program{"fullscreen.vert", "composite.frag"};
    Program line_program{"lines.vert", "lines.frag"};
    Program point_program{"points.vert", "points.frag"};
    Overlay overlay;

    Buffer frame_uniforms;
    Texture color_table, ground_openness, noise;
    std::string color_table_name;
    VertexArray no_attributes, line_array;
    Buffer line_buffer;
    PointBuffers points;

    std::vector<SurfaceBuffers> surfaces;
    Shapes shapes;
    OcclusionGrid occlusion;
    std::vector<std::uint8_t> ground_light;
    std::vector<Vector3f> outline;

    explicit Impl(const RendererDef& d) : def(d) {
        GLint samples = 0, largest = 0;
        glGetIntegerv(GL_MAX_SAMPLES, &samples);
        glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
        require_legal(def, samples, largest);
        targets.emplace(def.width, def.height, def.samples);
        shadow.emplace(def.shadow_map_size);
        for (const Texture* t : {&color_table, &ground_openness}) {
            glBindTexture(GL_TEXTURE_2D, t->get());
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        }
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        const std::uint8_t open = 255;
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, 1, 1, 0, GL_RED, GL_UNSIGNED_BYTE, &open);
        make_noise();
        require_no_gl_error("Renderer");
    }

    /// The grain of tissue: four channels of noise on a lattice of 32^3, the same on every machine.
    void make_noise() {
        constexpr int n = 32;
        std::vector<std::uint8_t> texels(std::size_t(4) * n * n * n);
        std::uint32_t state = 0x9e3779b9u;  // xorshift32 (G. Marsaglia, 2003)
        for (std::uint8_t& t : texels) {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            t = std::uint8_t(state >> 24);
        }
        glActiveTexture(GL_TEXTURE0 + kNoiseUnit);
        glBindTexture(GL_TEXTURE_3D, noise.get());
        glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, n, n, n, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
        glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
    }

    // ---- what a frame is made of ----

    static bool is_mapped(const SurfaceView& s) { return !s.scalar.empty() || !s.triangle_scalar.empty(); }

    struct Scene {
        Vector3f low = Vector3f::Constant(1e30f), high = Vector3f::Constant(-1e30f);  // of all that casts a shadow
        bool mapped = false;
    };

    Scene prepare(const FrameView& view, const SceneFrame& frame) {
        Scene scene;
        surfaces.resize(view.surfaces.size());
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            surfaces[i].prepare(view.surfaces[i], frame, "FrameView.surfaces[" + std::to_string(i) + "]");
            for (const SurfaceVertex& v : surfaces[i].vertices()) {
                scene.low = scene.low.cwiseMin(v.position);
                scene.high = scene.high.cwiseMax(v.position);
            }
            scene.mapped |= is_mapped(view.surfaces[i]);
        }
        points.prepare(view.points, frame);
        for (const Vector3f& p : points.positions()) {
            scene.low = scene.low.cwiseMin(p);
            scene.high = scene.high.cwiseMax(p);
        }
        scene.mapped |= !points.empty();
        if (scene.mapped && !view.scale)
            throw Error(ErrorCode::invalid_argument, "FrameView.scale",
                        "is empty, but a surface or points have a scalar; say which colours its values take");
        if (scene.mapped && !(std::isfinite(view.scale->low) && std::isfinite(view.scale->high) && view.scale->low < view.scale->high))
            throw Error(
                ErrorCode::invalid_argument, "FrameView.scale",
                "low = " + to_text(view.scale->low) + ", high = " + to_text(view.scale->high) + "; low < high is needed, both finite");
        add_shapes(view, frame, scene);
        if (!(scene.low.array() <= scene.high.array()).all()) {  // nothing but the studio
            scene.low.setConstant(-0.1f);
            scene.high.setConstant(0.1f);
        }
        return scene;
    }

    void add_shapes(const FrameView& view, const SceneFrame& frame, Scene& scene) {
        shapes.clear();
        for (std::size_t i = 0; i < view.markers.size(); ++i) {
            const MarkerView& m = view.markers[i];
            const std::string where = "FrameView.markers[" + std::to_string(i) + "]";
            require_finite(m.centre_m, where + ".centre_m");
            if (!(m.radius_m > 0 && std::isfinite(m.radius_m)))
                throw Error(ErrorCode::invalid_argument, where + ".radius_m", to_text(m.radius_m) + " is not a positive length");
            const Vector3f centre = frame.point(m.centre_m);
            const float radius = frame.length(m.radius_m);
            shapes.add_sphere(centre, radius, linear_of(m.color));
            scene.low = scene.low.cwiseMin((centre.array() - radius).matrix());
            scene.high = scene.high.cwiseMax((centre.array() + radius).matrix());
        }
        const Vector3f eye = frame.point(view.camera.eye_m);
        const float half = std::tan(float(view.camera.fov_deg) * 3.14159265f / 360);
        for (std::size_t i = 0; i < view.arrows.size(); ++i) {
            const ArrowView& a = view.arrows[i];
            const std::string where = "FrameView.arrows[" + std::to_string(i) + "]";
            require_finite(a.from_m, where + ".from_m");
            require_finite(a.to_m, where + ".to_m");
            const Vector3f from = frame.point(a.from_m), to = frame.point(a.to_m);
            // As wide on the picture wherever it stands: an arrow is an annotation, its length is the number.
            const float width = 0.021f * half * (0.5f * (from + to) - eye).norm();
            shapes.add_arrow(from, to, width, linear_of(a.color));
        }
    }

    void occlude(const Scene& scene, const Stage& stage, FrameUniforms& uniforms) {
        glActiveTexture(GL_TEXTURE0 + kOcclusionUnit);
        glBindTexture(GL_TEXTURE_2D, ground_openness.get());  // read where uniforms.ground_occlusion is not zero
        if (!def.ambient_occlusion || surfaces.empty()) return;
        occlusion.reset(scene.low, scene.high);
        for (const SurfaceBuffers& s : surfaces) s.add_to(occlusion);
        occlusion.finish();
        for (SurfaceBuffers& s : surfaces) s.occlude(occlusion);
        if (!stage.has_ground) return;
        occlusion.ground(stage.ground_height, ground_light);
        const Eigen::Vector2f low = occlusion.ground_low(), size = occlusion.ground_high() - low;
        uniforms.ground_occlusion = {low.x(), low.y(), 1 / size.x(), 1 / size.y()};
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, OcclusionGrid::kGroundSize, OcclusionGrid::kGroundSize, 0, GL_RED, GL_UNSIGNED_BYTE,
                     ground_light.data());
    }

    // ---- passes ----

    /// Makes a program with the units and the block it needs current.
    void use(const Program& program) const {
        program.use();
        program.set("shadow_map", kShadowUnit);
        program.set("shadow_depth", kShadowUnit);
        program.set("color_table", kColorUnit);
        program.set("ground_mask", kGroundUnit);
        program.set("ground_shadow", kGroundUnit);
        program.set("scene", kSceneUnit);
        program.set("noise", kNoiseUnit);
        program.set("triangle_values", kValuesUnit);
        program.set("opacity", 1.0f);
        program.set("occlusion", kOcclusionUnit);
    }

    const Program& surface_program(const std::string& defines) {
        const auto found = surface_programs.find(defines);
        if (found != surface_programs.end()) return found->second;
        return surface_programs.emplace(defines, Program("surface.vert", "surface.frag", defines)).first->second;
    }

    void draw_shadows(const Stage& stage) {
        shadow->bind_map();
        glEnable(GL_POLYGON_OFFSET_FILL);
        glPolygonOffset(1.5f, 2.0f);
        depth_program.use();
        depth_program.set("to_light", stage.to_light);
        for (const SurfaceBuffers& s : surfaces) s.draw();
        if (!shapes.empty()) shapes.draw_casters();
        glDisable(GL_POLYGON_OFFSET_FILL);
        if (!stage.has_ground) return;
        glDisable(GL_DEPTH_TEST);
        shadow->bind_ground_mask();
        shadow->use_map_depth(kShadowUnit);
        use(ground_mask_program);
        ground_mask_program.set("ground_depth", stage.ground_depth());
        fill();
        shadow->finish_ground_mask();
        shadow->bind_ground();
        shadow->use_ground_mask(kGroundUnit);
        use(ground_soften_program);
        fill();
        shadow->use_ground(kGroundUnit);
        glEnable(GL_DEPTH_TEST);
    }

    void fill() const {
        glBindVertexArray(no_attributes.get());
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

    void use_color_table(const ColorScale& scale) {
        glActiveTexture(GL_TEXTURE0 + kColorUnit);
        glBindTexture(GL_TEXTURE_2D, color_table.get());
        if (color_table_name == scale.map) return;
        const ColorTable& table = color_map(scale.map);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, GLsizei(table.size()), 1, 0, GL_RGB, GL_UNSIGNED_BYTE, table.data());
        color_table_name = scale.map;
    }

    void draw_surfaces(const FrameView& view) {
        shadow->use_map_compared(kShadowUnit);
        glActiveTexture(GL_TEXTURE0 + kNoiseUnit);
        glBindTexture(GL_TEXTURE_3D, noise.get());
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            if (view.surfaces[i].opacity == 1) draw_surface(view, i);
        if (!shapes.empty()) {
            use(surface_program("LOOK=4"));
            shapes.draw();
        }
        draw_points(view);
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            if (view.surfaces[i].opacity < 1) draw_translucent(view, i);
    }

    void draw_surface(const FrameView& view, std::size_t i) {
        const SurfaceView& s = view.surfaces[i];
        const bool mapped = is_mapped(s), flat = !s.triangle_scalar.empty(), grain = !mapped && s.look == Look::tissue && surfaces[i].has_grain();
        const bool inner = !mapped && surfaces[i].has_inner();
        const Program& program =
            surface_program("LOOK=" + std::to_string(int(s.look)) + (mapped ? " MAPPED" : "") + (flat ? " FLAT" : "") + (grain ? " GRAIN" : "") + (inner ? " INNER" : ""));
        use(program);
        program.set("opacity", float(s.opacity));
        if (mapped) use_scale(program, *view.scale);
        if (flat) surfaces[i].bind_values(kValuesUnit);
        const Vector3f color = s.color ? linear_of(*s.color) : default_color(s.look);
        glVertexAttrib3f(3, color.x(), color.y(), color.z());
        if (inner) program.set("inner_color", s.inner_color ? linear_of(*s.inner_color) : inner_color(s.look, color));
        surfaces[i].draw();
    }

    /// The nearest layer alone, over what is already there: first its depth, then its colour where that is the nearest.
    void draw_translucent(const FrameView& view, std::size_t i) {
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        draw_surface(view, i);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_LEQUAL);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // keeps the coverage right
        draw_surface(view, i);
        glDisable(GL_BLEND);
        glDepthFunc(GL_LESS);
    }

    void use_scale(const Program& program, const ColorScale& scale) {
        use_color_table(scale);
        program.set("value_range", Eigen::Vector2f(float(scale.low), float(1 / (scale.high - scale.low))));
    }

    void draw_points(const FrameView& view) {
        if (points.empty()) return;
        use(point_program);
        use_scale(point_program, *view.scale);
        glEnable(GL_PROGRAM_POINT_SIZE);
        points.draw([&](float size_px) { point_program.set("size", size_px); });
        glDisable(GL_PROGRAM_POINT_SIZE);
    }

    void draw_studio(const Stage& stage) {
        const Program& program = stage.has_ground ? ground_program : backdrop_program;
        use(program);
        program.set("forward", stage.forward);
        program.set("right", stage.right);
        program.set("above", stage.above);
        fill();
    }

    /// Draws bodies, tools and lines alone, in the part of the picture that they cover, and lays them over the studio.
    void draw_scene(const FrameView& view, const SceneFrame& frame, const Stage& stage) {
        collect_outlines(view, frame, stage);
        const ScreenBox box = screen_box(stage);
        if (box.width < 1 || box.height < 1) return;
        glEnable(GL_SCISSOR_TEST);
        glScissor(box.x, box.y, box.width, box.height);
        targets->bind_scene();
        glEnable(GL_DEPTH_TEST);
        glClearColor(0, 0, 0, 0);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        if (stage.has_ground) glEnable(GL_CLIP_DISTANCE0);  // the ground has no depth: what is below it is cut away
        draw_surfaces(view);
        draw_lines();
        glDisable(GL_CLIP_DISTANCE0);
        glDisable(GL_DEPTH_TEST);
        targets->resolve_scene(box.x, box.y, box.width, box.height);
        targets->bind_result();
        targets->use_scene(kSceneUnit);
        use(composite_program);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        fill();
        glDisable(GL_BLEND);
        glDisable(GL_SCISSOR_TEST);
    }

    struct ScreenBox {
        int x = 0, y = 0, width = 0, height = 0;
    };

    ScreenBox screen_box(const Stage& stage) const {
        Eigen::Vector2f low(1, 1), high(-1, -1);
        const auto include = [&](const Vector3f& p) {
            const Vector4f c = stage.view_projection * Vector4f(p.x(), p.y(), p.z(), 1);
            if (c.w() < 1e-4f) {  // beside or behind the eye: it may reach anywhere
                low.setConstant(-1);
                high.setConstant(1);
                return;
            }
            low = low.cwiseMin(c.head<2>() / c.w());
            high = high.cwiseMax(c.head<2>() / c.w());
        };
        for (const SurfaceBuffers& s : surfaces)
            for (const SurfaceVertex& v : s.vertices()) include(v.position);
        for (const SurfaceVertex& v : shapes.vertices()) include(v.position);
        for (const Vector3f& p : outline) include(p);
        for (const Vector3f& p : points.positions()) include(p);
        const auto pixel = [](float ndc, int size) { return std::clamp((0.5f + 0.5f * ndc) * float(size), -2.0f, float(size) + 2); };
        const int reach = points.reach_px();
        const int x0 = std::max(0, int(pixel(low.x(), def.width)) - 2 - reach), x1 = std::min(def.width, int(pixel(high.x(), def.width)) + 3 + reach);
        const int y0 = std::max(0, int(pixel(low.y(), def.height)) - 2 - reach), y1 = std::min(def.height, int(pixel(high.y(), def.height)) + 3 + reach);
        return {x0, y0, x1 - x0, y1 - y0};
    }

    void collect_outlines(const FrameView& view, const SceneFrame& frame, const Stage& stage) {
        outline.clear();
        for (std::size_t i = 0; i < surfaces.size(); ++i) surfaces[i].append_rest_outline(view.surfaces[i], frame, stage.eye, outline);
    }

    void draw_lines() {
        bool any = false;
        for (const SurfaceBuffers& s : surfaces) any |= s.has_edges();
        if (!any && outline.empty()) return;
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // keeps the coverage right
        glDepthMask(GL_FALSE);
        use(line_program);
        line_program.set("pull", 0.0025f);
        line_program.set("color", Vector4f(0.012f, 0.014f, 0.018f, 0.42f));
        for (const SurfaceBuffers& s : surfaces)
            if (s.has_edges()) s.draw_edges();
        if (!outline.empty()) {
            glBindVertexArray(line_array.get());
            upload_buffer(GL_ARRAY_BUFFER, line_buffer, std::span<const Vector3f>(outline), GL_STREAM_DRAW);
            glEnableVertexAttribArray(0);
            glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
            line_program.set("color", Vector4f(0.80f, 0.86f, 0.94f, 0.40f));
            glDrawArrays(GL_LINES, 0, GLsizei(outline.size()));
        }
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
    }

    void set_state() {
        glDisable(GL_BLEND);
        glDisable(GL_CULL_FACE);
        glDisable(GL_SCISSOR_TEST);
        glDisable(GL_CLIP_DISTANCE0);
        glDisable(GL_STENCIL_TEST);
        glDisable(GL_POLYGON_OFFSET_FILL);
        glEnable(GL_MULTISAMPLE);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        glEnable(GL_FRAMEBUFFER_SRGB);
        for (GLuint unit = 0; unit < kUnits; ++unit) glBindSampler(unit, 0);
    }

    void leave() {
        for (GLuint unit = 0; unit < kUnits; ++unit) glBindSampler(unit, 0);
        glBindVertexArray(0);
        glUseProgram(0);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
    }

    DrawReport draw(const FrameView& view) {
        auto start = std::chrono::steady_clock::now();
        DrawReport report;
        supple::require_legal(view.camera);
        if (view.scale) color_map(view.scale->map);  // an unknown name is refused before anything is drawn
        const SceneFrame frame(view.camera);
        set_state();
        const Scene scene = prepare(view, frame);
        const Stage stage(view, frame, scene.low, scene.high, float(def.width) / float(def.height), def.shadow_map_size);
        FrameUniforms uniforms = stage.uniforms(def.height, shadow->size(), shadow->ground_size());
        occlude(scene, stage, uniforms);
        for (SurfaceBuffers& s : surfaces) {
            s.upload();
            report.triangles += s.triangle_count();
        }
        shapes.upload();
        points.upload();
        upload_buffer(GL_UNIFORM_BUFFER, frame_uniforms, std::span<const FrameUniforms>(&uniforms, 1), GL_STREAM_DRAW);
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_uniforms.get());  // every block is bound to point 0 from the start
        report.prepare_ms = ms_since(start);

        start = std::chrono::steady_clock::now();
        draw_shadows(stage);
        targets->bind_result();
        glDisable(GL_DEPTH_TEST);
        draw_studio(stage);
        draw_scene(view, frame, stage);
        glDisable(GL_FRAMEBUFFER_SRGB);  // text is designed in sRGB, and blended as every other program does it
        annotate(overlay, view, scene.mapped, def.width, def.height);
        overlay.draw();
        leave();
        report.draw_ms = ms_since(start);
        require_no_gl_error("Renderer.draw");
        return report;
    }
};

Renderer::Renderer(const RendererDef& def) {
    require_context();
    impl_ = std::make_unique<Impl>(def);
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

DrawReport Renderer::draw(const FrameView& view) { return impl_->draw(view); }

void Renderer::read_pixels(Image& into) const {
    const int w = impl_->def.width, h = impl_->def.height;
    const std::size_t row = std::size_t(w) * 4;
    // Four channels, because every driver has a short way for them.
    thread_local std::vector<std::uint8_t> rgba;
    rgba.resize(row * std::size_t(h));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->result());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    require_no_gl_error("Renderer.read_pixels");
    into.width = w;
    into.height = h;
    into.rgb.resize(std::size_t(w) * std::size_t(h) * 3);
    std::uint8_t* out = into.rgb.data();
    for (int y = h - 1; y >= 0; --y) {  // OpenGL counts from below
        const std::uint8_t* in = rgba.data() + row * std::size_t(y);
        for (int x = 0; x < w; ++x, in += 4, out += 3) {
            out[0] = in[0];
            out[1] = in[1];
            out[2] = in[2];
        }
    }
}

Image Renderer::read_pixels() const {
    Image image;
    read_pixels(image);
    return image;
}

void Renderer::blit_to(unsigned framebuffer, int width, int height, int x, int y) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->targets->result());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glDisable(GL_FRAMEBUFFER_SRGB);
    const bool same = width == impl_->def.width && height == impl_->def.height;
    glBlitFramebuffer(0, 0, impl_->def.width, impl_->def.height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

void Renderer::resize(int width, int height) {
    RendererDef def = impl_->def;
    if (def.width == width && def.height == height) return;
    def.width = width;
    def.height = height;
    GLint samples = 0, largest = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &samples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    require_legal(def, samples, largest);
    impl_->targets.emplace(width, height, def.samples);
    impl_->def = def;
}

int Renderer::width() const { return impl_->def.width; }
int Renderer::height() const { return impl_->def.height; }

}  // namespace supple
