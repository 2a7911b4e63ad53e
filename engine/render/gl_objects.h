#pragma once
#include <epoxy/gl.h>

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace supple::render {

/// Owns one OpenGL name; the context that made it must be current where it is destroyed.
template <class Kind>
class GlObject {
public:
    GlObject() = default;
    ~GlObject() { reset(); }
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    /// The name, made at the first call.
    GLuint get() const {
        if (name_ == 0) Kind::make(&name_);
        return name_;
    }
    void reset() {
        if (name_ != 0) Kind::destroy(&name_);
        name_ = 0;
    }

private:
    mutable GLuint name_ = 0;
};

struct BufferKind {
    static void make(GLuint* n) { glGenBuffers(1, n); }
    static void destroy(GLuint* n) { glDeleteBuffers(1, n); }
};
struct VertexArrayKind {
    static void make(GLuint* n) { glGenVertexArrays(1, n); }
    static void destroy(GLuint* n) { glDeleteVertexArrays(1, n); }
};
struct TextureKind {
    static void make(GLuint* n) { glGenTextures(1, n); }
    static void destroy(GLuint* n) { glDeleteTextures(1, n); }
};
struct SamplerKind {
    static void make(GLuint* n) { glGenSamplers(1, n); }
    static void destroy(GLuint* n) { glDeleteSamplers(1, n); }
};
struct FramebufferKind {
    static void make(GLuint* n) { glGenFramebuffers(1, n); }
    static void destroy(GLuint* n) { glDeleteFramebuffers(1, n); }
};
struct RenderbufferKind {
    static void make(GLuint* n) { glGenRenderbuffers(1, n); }
    static void destroy(GLuint* n) { glDeleteRenderbuffers(1, n); }
};
using Buffer = GlObject<BufferKind>;
using VertexArray = GlObject<VertexArrayKind>;
using Texture = GlObject<TextureKind>;
using Sampler = GlObject<SamplerKind>;
using Framebuffer = GlObject<FramebufferKind>;
using Renderbuffer = GlObject<RenderbufferKind>;

/// Replaces the whole content; the driver gives a fresh block, so it never waits for the frame before.
template <class T>
void upload_buffer(GLenum target, const Buffer& buffer, std::span<const T> data, GLenum usage) {
    glBindBuffer(target, buffer.get());
    glBufferData(target, GLsizeiptr(data.size_bytes()), data.data(), usage);
}

/// A linked program of two embedded shader files. Lines `#include "x.glsl"` are replaced by that file.
class Program {
public:
    /// @param defines  words for the preprocessor, separated by blanks: "MAPPED LOOK=2"
    /// @error Error(unsupported) with the name of the file and the log of the driver
    Program(std::string_view vertex_file, std::string_view fragment_file, std::string_view defines = {});
    ~Program();
    Program(Program&& other) noexcept : name_(std::exchange(other.name_, 0)), uniforms_(std::move(other.uniforms_)) {}
    Program& operator=(Program&&) = delete;

    void use() const { glUseProgram(name_); }
    void set(const char* uniform, float v) const { glUniform1f(location(uniform), v); }
    void set(const char* uniform, int v) const { glUniform1i(location(uniform), v); }
    void set(const char* uniform, const Eigen::Vector2f& v) const { glUniform2f(location(uniform), v.x(), v.y()); }
    void set(const char* uniform, const Eigen::Vector3f& v) const { glUniform3f(location(uniform), v.x(), v.y(), v.z()); }
    void set(const char* uniform, const Eigen::Vector4f& v) const { glUniform4f(location(uniform), v.x(), v.y(), v.z(), v.w()); }
    void set(const char* uniform, const Eigen::Matrix4f& v) const { glUniformMatrix4fv(location(uniform), 1, GL_FALSE, v.data()); }

private:
    GLint location(const char* uniform) const;  // -1 (ignored by GL) where the variant does not use it
    GLuint name_ = 0;
    mutable std::unordered_map<std::string, GLint> uniforms_;
};

/// @error Error(unsupported) if the framebuffer that is bound to `target` is incomplete
void require_complete(GLenum target, const char* what);

/// @error Error(unsupported) if OpenGL reports an error since the last call
void require_no_gl_error(const char* where);

/// Bytes of a file of shaders/ by its name; of the font. Empty for an unknown name. Generated at build time.
std::span<const unsigned char> embedded_shader(std::string_view name);
std::span<const unsigned char> embedded_font(std::string_view name);

/// Shader text with its includes and defines, as the driver gets it. @error Error(unsupported) for an unknown file
std::string shader_source(std::string_view file, std::string_view defines);

}  // namespace supple::render
