// Results as VTU files, one per body and frame, and the .pvd list of them (ParaView's collection file).
#include <cmath>

#include "supple/io/binary_file.h"
#include "supple/io/number_text.h"
#include "supple/io/result_parts.h"
#include "supple/io/vtk_names.h"
#include "supple/io/vtu_writer.h"

namespace supple::io {

namespace fs = std::filesystem;

namespace {

std::vector<double> flat(std::span<const Vec3> vectors) {
    std::vector<double> out;
    out.reserve(3 * vectors.size());
    for (const Vec3& v : vectors) out.insert(out.end(), {v.x(), v.y(), v.z()});
    return out;
}

std::vector<double> flat(std::span<const Voigt> tensors) {
    std::vector<double> out;
    out.reserve(6 * tensors.size());
    for (const Voigt& t : tensors) out.insert(out.end(), t.begin(), t.end());
    return out;
}

/// sqrt(2/3 e:e) of a strain with engineering shears.
std::vector<double> equivalent(std::span<const Voigt> strains) {
    std::vector<double> out;
    for (const Voigt& e : strains)
        out.push_back(std::sqrt(2.0 / 3 * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + (e[3] * e[3] + e[4] * e[4] + e[5] * e[5]) / 2)));
    return out;
}

/// A body as it stands.
std::string format_body(const World& world, BodyId body) {
    const VolumeMesh& mesh = world.shape(body).mesh();
    const std::span<const Vec3> positions = world.positions(body);
    const std::vector<Vec3> start = world.start_positions(body);
    std::vector<Vec3> moved;
    for (std::size_t v = 0; v < start.size(); ++v) moved.push_back(positions[v] - start[v]);
    VtuWriter writer(VtuEncoding::appended_zlib);
    writer.point_data("displacement_m", 3, flat(moved));
    writer.point_data("velocity_m_s", 3, flat(world.velocities(body)));
    writer.point_data("stress_pa", 6, flat(world.cauchy_stress(body)));
    writer.point_data("von_mises_pa", 1, world.von_mises(body));
    for (const VertexGroup& group : mesh.groups) {
        std::vector<std::uint8_t> marks(mesh.vertices.size(), 0);
        for (const std::int32_t v : group.vertices) marks[std::size_t(v)] = 1;
        writer.point_data(std::string(kGroupPrefix) + group.name, marks);
    }
    writer.cell_data("stress_pa", 6, flat(world.element_cauchy_stress(body)));
    writer.cell_data("von_mises_pa", 1, world.element_von_mises(body));
    const std::vector<Voigt> plastic = world.plastic_strain(body);
    if (!plastic.empty()) writer.cell_data("plastic_strain", 1, equivalent(plastic));
    const std::vector<int> tags = region_tags(mesh);
    for (std::size_t r = 0; r < tags.size(); ++r) writer.field(std::string(kRegionPrefix) + mesh.regions[r].name, tags[r]);
    if (!tags.empty()) writer.cell_data(kRegionArray, element_tags(mesh));
    return writer.finish(positions, mesh.tets, mesh.hexes);
}

/// A name that a file may have: letters, figures and a few signs.
std::string file_word(const std::string& name) {
    std::string out;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
        out += plain ? c : '_';
    }
    return out;
}

class VtuExport final : public ResultExport {
public:
    VtuExport(fs::path folder, std::string stem, fs::path list)
        : folder_(std::move(folder)), stem_(std::move(stem)), list_(std::move(list)) {}

    void add_frame(const World& world) override {
        const std::vector<BodyId> bodies = world.bodies();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const std::string name =
                stem_ + std::to_string(b) + "_" + file_word(world.name(bodies[b])) + "_" + frame_number(world.step_count()) + ".vtu";
            write_text_file(folder_ / name, format_body(world, bodies[b]));
            entries_ += "<DataSet timestep=\"";
            append(entries_, world.time_s());
            entries_ += "\" group=\"\" part=\"" + std::to_string(b) + "\" name=\"" + escape_xml(world.name(bodies[b])) + "\" file=\"" +
                        name + "\"/>\n";
        }
    }
    void finish() override {
        write_text_file(
            list_, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n" +
                       entries_ + "</Collection>\n</VTKFile>\n");
    }

private:
    fs::path folder_;
    std::string stem_;
    fs::path list_;
    std::string entries_;
};

class LastVtuExport final : public ResultExport {
public:
    explicit LastVtuExport(fs::path file) : file_(std::move(file)) {}
    void add_frame(const World& world) override { text_ = format_body(world, world.bodies()[0]); }
    void finish() override { write_text_file(file_, text_); }

private:
    fs::path file_;
    std::string text_;
};

}  // namespace

std::unique_ptr<ResultExport> make_vtu_export(const fs::path& folder, const std::string& stem, const fs::path& list) {
    return std::make_unique<VtuExport>(folder, stem, list);
}

std::unique_ptr<ResultExport> make_last_vtu_export(const fs::path& file) { return std::make_unique<LastVtuExport>(file); }

}  // namespace supple::io
