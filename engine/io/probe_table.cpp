#include "supple/io/probe_table.h"

#include <charconv>

#include "supple/io/binary_file.h"

namespace supple::io {

namespace {

void append(std::string& text, double value) {
    char digits[40];
    text += ',';
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr);
}

std::string csv_word(const std::string& word) {
    if (word.find_first_of(",\"\r\n") == std::string::npos) return word;
    std::string quoted = "\"";
    for (const char c : word) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

}  // namespace

std::vector<Probe> make_probes(const Scene& scene, const World& world) {
    std::vector<Probe> probes;
    const std::vector<BodyId> bodies = world.bodies();
    for (std::size_t b = 0; b < scene.bodies.size() && b < bodies.size(); ++b)
        for (const ProbeDef& def : scene.bodies[b].probes) probes.emplace_back(world, bodies[b], def);
    return probes;
}

ProbeTable::ProbeTable()
    : text_("step,time_s,body,probe,peak_von_mises_pa,mean_von_mises_pa,peak_at,over_threshold_s,peak_displacement_m,mean_displacement_m,displaced_s\n") {}

void ProbeTable::add(const World& world, const Probe& probe) {
    const ProbeSample& s = probe.sample();
    text_ += std::to_string(world.step_count());
    append(text_, s.time_s);
    text_ += ',' + csv_word(world.name(probe.body())) + ',' + csv_word(probe.def().name);
    append(text_, s.peak_von_mises_pa);
    append(text_, s.mean_von_mises_pa);
    text_ += ',' + std::to_string(s.peak_at);
    for (const double value : {s.over_threshold_s, s.peak_displacement_m, s.mean_displacement_m, s.displaced_s}) append(text_, value);
    text_ += '\n';
}

void ProbeTable::write(const std::filesystem::path& file) const { write_text_file(file, text_); }

}  // namespace supple::io
