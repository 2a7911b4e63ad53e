#include "supple/render/gl_objects.h"

#include <sstream>
#include <vector>

#include "supple/base/error.h"

namespace supple::render {
namespace {

std::string text_of(std::string_view file) {
    const auto bytes = embedded_shader(file);
    if (bytes.empty())
        throw Error(ErrorCode::unsupported, std::string(file), "no shader of this name is built in; shaders/ holds them all");
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// GLSL 3.30 has no #include. `files` collects the names: the number in a #line, and so in the driver's log, is an index into it.
void append_file(std::string& out, std::string_view file, std::vector<std::string>& files) {
    const std::size_t index = files.size();
    files.emplace_back(file);
    std::istringstream lines(text_of(file));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        constexpr std::string_view kInclude = "#include \"";
        if (!line.starts_with(kInclude)) {
            out += line + '\n';
            continue;
        }
        const std::string included = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
        out += "#line 1 " + std::to_string(files.size()) + '\n';
        append_file(out, included, files);
        out += "#line " + std::to_string(number + 1) + ' ' + std::to_string(index) + '\n';
    }
}

std::string assemble(std::string_view file, std::string_view defines, std::vector<std::string>& files) {
    std::string out = "#version 330 core\n";
    std::istringstream words{std::string(defines)};
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        out += "#define " + word.substr(0, equals) + ' ' + (equals == std::string::npos ? "1" : word.substr(equals + 1)) + '\n';
    }
    out += "#line 1 0\n";
    append_file(out, file, files);
    return out;
}

GLuint compile(GLenum stage, std::string_view file, std::string_view defines) {
    std::vector<std::string> files;
    const std::string source = assemble(file, defines, files);
    const GLuint shader = glCreateShader(stage);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    char log[4000] = {};
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    std::string message = "the driver does not compile this shader";
    if (!defines.empty()) message += " (with " + std::string(defines) + ")";
    message += ":\n" + std::string(log);
    for (std::size_t i = 0; i < files.size() && files.size() > 1; ++i)
        message += "file " + std::to_string(i) + " is shaders/" + files[i] + "\n";
    throw Error(ErrorCode::unsupported, "shaders/" + std::string(file), message);
}

}  // namespace

std::string shader_source(std::string_view file, std::string_view defines) {
    std::vector<std::string> files;
    return assemble(file, defines, files);
}

Program::Program(std::string_view vertex_file, std::string_view fragment_file, std::string_view defines) {
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_file, defines);
    GLuint fragment = 0;
    try {
        fragment = compile(GL_FRAGMENT_SHADER, fragment_file, defines);
    } catch (...) {
        glDeleteShader(vertex);
        throw;
    }
    name_ = glCreateProgram();
    glAttachShader(name_, vertex);
    glAttachShader(name_, fragment);
    glLinkProgram(name_);
    glDeleteShader(vertex);  // the program keeps them as long as it needs them
    glDeleteShader(fragment);
    GLint good = 0;
    glGetProgramiv(name_, GL_LINK_STATUS, &good);
    if (good) return;
    char log[4000] = {};
    glGetProgramInfoLog(name_, sizeof log, nullptr, log);
    glDeleteProgram(name_);
    throw Error(ErrorCode::unsupported, "shaders/" + std::string(vertex_file) + " + " + std::string(fragment_file),
                "the driver does not link these shaders:\n" + std::string(log));
}

Program::~Program() {
    if (name_ != 0) glDeleteProgram(name_);
}

GLint Program::location(const char* uniform) const {
    const auto found = uniforms_.find(uniform);
    if (found != uniforms_.end()) return found->second;
    return uniforms_[uniform] = glGetUniformLocation(name_, uniform);
}

void require_complete(GLenum target, const char* what) {
    const GLenum status = glCheckFramebufferStatus(target);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw Error(ErrorCode::unsupported, what,
                    "the driver cannot draw into this framebuffer (status " + std::to_string(status) +
                        "); try other sizes or samples in RendererDef");
}

void require_no_gl_error(const char* where) {
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR) return;
    throw Error(ErrorCode::unsupported, where,
                code == GL_OUT_OF_MEMORY
                    ? std::string("the graphics driver is out of memory; draw smaller pictures or fewer triangles")
                    : "OpenGL error " + std::to_string(code) + "; was another program part using this context in between?");
}

}  // namespace supple::render
