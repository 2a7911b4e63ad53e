#pragma once
#include "supple/render/gl_objects.h"

namespace supple::render {

/// The framebuffers of a renderer: one with several samples a pixel for the scene alone, on nothing, and one with a single sample for the
/// studio, the scene over it, and the text. (A software driver spends four times as long on everything that has four samples.)
class Targets {
public:
    /// @param samples  0 for none: then the scene is drawn to the result itself. @error Error(unsupported)
    Targets(int width, int height, int samples);
    void bind_scene() const;
    void bind_result() const;
    void resolve_scene(int x, int y, int width, int height) const;  ///< that part of it, to the texture of use_scene()
    void use_scene(int unit) const;
    GLuint result() const { return result_.get(); }

private:
    int width_, height_, samples_;
    Framebuffer scene_, resolved_, result_;
    Renderbuffer scene_color_, scene_depth_;
    Texture resolved_color_, result_color_;
};

/// The shadow map of the key light, and the soft shadow on the ground that is made from it.
class ShadowTargets {
public:
    explicit ShadowTargets(int size);
    void bind_map() const;  ///< cleared
    void bind_ground_mask() const;
    void finish_ground_mask() const;  ///< builds its mip levels
    void bind_ground() const;
    int size() const { return size_; }
    int ground_size() const { return size_ / 2; }

    /// To be sampled with comparison (filtered), or as plain depths.
    void use_map_compared(int unit) const;
    void use_map_depth(int unit) const;
    void use_ground_mask(int unit) const;
    void use_ground(int unit) const;

private:
    int size_;
    Framebuffer map_, mask_, ground_;
    Texture map_depth_, ground_mask_, ground_shadow_;
    Sampler compared_, plain_;
};

}  // namespace supple::render
