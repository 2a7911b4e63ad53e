#include "view/gui.h"

// After imgui.h: the backends use it without including it.
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string_view>

#include "supple/base/error.h"

namespace supple::render {
std::span<const unsigned char> embedded_font(std::string_view name);  // render/gl_objects.h, without the rest of it
}

namespace supple::demos::view {
namespace {

constexpr float kFont_px = 15;

/// To three digits: a number that a person can read.
double rounded(double value) {
    if (value == 0 || !std::isfinite(value)) return value;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2);
    return unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit;
}

void set_style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.FrameRounding = 4;
    style.GrabRounding = 4;
    style.PopupRounding = 4;
    style.WindowBorderSize = 0;
    style.ScrollbarSize = 12;
    style.ItemSpacing = ImVec2(6, 5);
    style.FramePadding = ImVec2(7, 3);
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.105f, 0.115f, 0.13f, 1);
    style.Colors[ImGuiCol_PopupBg] = ImVec4(0.13f, 0.14f, 0.16f, 0.98f);
    style.Colors[ImGuiCol_FrameBg] = ImVec4(0.19f, 0.21f, 0.24f, 1);
    style.Colors[ImGuiCol_FrameBgHovered] = ImVec4(0.24f, 0.27f, 0.31f, 1);
    style.Colors[ImGuiCol_Header] = ImVec4(0.17f, 0.24f, 0.31f, 1);
    style.Colors[ImGuiCol_HeaderHovered] = ImVec4(0.21f, 0.31f, 0.41f, 1);
    style.Colors[ImGuiCol_Button] = ImVec4(0.20f, 0.27f, 0.34f, 1);
    style.Colors[ImGuiCol_ButtonHovered] = ImVec4(0.26f, 0.37f, 0.48f, 1);
    style.Colors[ImGuiCol_SliderGrab] = ImVec4(0.26f, 0.45f, 0.64f, 1);
    style.Colors[ImGuiCol_Text] = ImVec4(0.93f, 0.94f, 0.95f, 1);
    style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.62f, 0.65f, 0.69f, 1);
    style.ScaleAllSizes(scale);
}

}  // namespace

Gui::Gui(GLFWwindow* window, float scale, bool hears) : scale_(scale) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // nothing is written behind the user's back
    io.LogFilename = nullptr;
    const auto bytes = render::embedded_font("DejaVuSans.ttf");
    ImFontConfig font;
    font.FontDataOwnedByAtlas = false;
    font.OversampleH = 2;
    static const ImWchar kLetters[] = {0x20, 0xFF, 0x2010, 0x2027, 0x2190, 0x2193, 0x25A0, 0x25FF, 0};
    io.Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(bytes.data()), int(bytes.size()), std::round(kFont_px * scale), &font, kLetters);
    set_style(scale);
    if (!ImGui_ImplGlfw_InitForOpenGL(window, hears) || !ImGui_ImplOpenGL3_Init("#version 330"))
        throw Error(ErrorCode::no_display, "window", "Dear ImGui could not be started on it: its OpenGL is below 3.3");
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Gui::begin_backend() const {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
}

void Gui::draw() const {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Controls& controls() {
    static Controls all;
    return all;
}

void Controls::mark(const std::string& name) {
    if (name == wanted_) ImGui::SetScrollHereY(0.5f);
    now_[name] = {ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), ImGui::CalcItemWidth(), ImGui::IsItemVisible()};
}

void tooltip(const char* help) {
    if (help == nullptr || *help == '\0' || !ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    ImGui::TextUnformatted(help);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool slider(const char* label, const char* id, double& value, double low, double high, const char* format, const char* help, bool logarithmic) {
    // A logarithmic slider of Dear ImGui ends at 10^-digits of its format and takes %e for minus one digit: formats are %g with as many digits as
    // the smallest value needs, and the value is rounded here.
    const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoRoundToFormat : ImGuiSliderFlags_None;
    const bool changed = ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, format, flags);
    if (changed && logarithmic) value = rounded(value);
    controls().mark(id);
    tooltip(help);
    return changed;
}

bool percent_slider(const char* label, const char* id, double& part, double low, double high, const char* help) {
    double percent = 100 * part;
    const bool changed = slider(label, id, percent, 100 * low, 100 * high, "%.0f %%", help);
    if (changed) part = std::max(0.0, percent / 100);
    return changed;
}

bool force_slider(double& max_force_n) {
    const char* format = max_force_n > 0 ? "%.3g N" : "2 x weight";
    const bool changed = slider("Most force", "tool force", max_force_n, 0, 1000, format, "the spring never exceeds it; 0: twice the weight of the body", true);
    max_force_n = std::max(0.0, max_force_n);
    return changed;
}

bool checkbox(const char* label, const char* id, bool& on, const char* help) {
    const bool changed = ImGui::Checkbox(label, &on);
    controls().mark(id);
    tooltip(help);
    return changed;
}

bool button(const char* label, const char* id, const char* help, bool lit) {
    if (lit) ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.20f, 0.48f, 0.72f, 1));
    const bool pressed = ImGui::Button(label);
    if (lit) ImGui::PopStyleColor();
    controls().mark(id);
    tooltip(help);
    return pressed;
}

void sentence(const std::string& text) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
}

void quiet_sentence(const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    sentence(text);
    ImGui::PopStyleColor();
}

bool header(const char* label, bool open_at_first) {
    const bool open = ImGui::CollapsingHeader(label, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    const std::string name(label);
    const std::size_t hashes = name.find("###");  // what follows them stays where the words before them change
    controls().mark(hashes == std::string::npos ? name : name.substr(hashes + 3));
    return open;
}

}  // namespace supple::demos::view
