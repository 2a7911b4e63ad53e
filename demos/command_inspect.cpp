#include <cstdio>
#include <memory>

#include "command.h"
#include "json_text.h"
#include "material_option.h"
#include "output_files.h"
#include "supple/base/error.h"
#include "supple/io/matrix_market.h"
#include "supple/io/mesh_file.h"
#include "supple/io/text_files.h"
#include "supple/world/inspect.h"

namespace supple::demos {
namespace {

struct InspectOptions {
    std::string mesh, material = "{}", positions, matrix, out;
    double scale = 1, density_kg_m3 = 1000, rayleigh_mass_1_s = 0, rayleigh_stiffness_s = 0;
    std::int64_t element = -1;
};

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return std::isfinite(value) ? text : "null";
}

template <class Matrix>
std::string rows_of(const Matrix& m) {
    std::vector<std::string> rows;
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
        std::vector<std::string> row;
        for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(number(m(r, c)));
        rows.push_back(json_array(row));
    }
    return json_array(rows, ",\n    ");
}

std::string list_of(const std::vector<Vec3>& points) {
    std::vector<std::string> all;
    for (const Vec3& p : points) all.push_back("[" + number(p.x()) + ", " + number(p.y()) + ", " + number(p.z()) + "]");
    return json_array(all, ",\n    ");
}

JsonObject element_object(const ElementView& view, std::int64_t index) {
    std::vector<std::string> vertices, stress;
    for (const std::int32_t v : view.vertices) vertices.push_back(json(v));
    for (const double s : view.cauchy_pa) stress.push_back(number(s));
    JsonObject o;
    o.add("element", std::to_string(index))
        .add("vertices", json_array(vertices))
        .add("rest_volume_m3", number(view.rest_volume_m3))
        .add("energy_j", number(view.energy_j))
        .add("cauchy_pa", json_array(stress))
        .add("deformation_gradient", rows_of(view.deformation_gradient))
        .add("initial_rotation", rows_of(view.initial_rotation))
        .add("rotation", rows_of(view.rotation))
        .add("rest_shape_m", list_of(view.rest_shape_m))
        .add("rotated_rest_shape_m", list_of(view.rotated_rest_shape_m))
        .add("strain_displacement_1_m", rows_of(view.strain_displacement))
        .add("material_matrix_pa", rows_of(view.material_matrix))
        .add("initial_stiffness_n_m", rows_of(view.initial_stiffness))
        .add("stiffness_n_m", rows_of(view.stiffness));
    return o;
}

int inspect(const InspectOptions& o) {
    require_writable(o.out);
    WorldDef def;
    def.threads = 1;
    def.solver.rayleigh_mass_1_s = o.rayleigh_mass_1_s;
    def.solver.rayleigh_stiffness_s = o.rayleigh_stiffness_s;
    World world(def);
    const auto shape = BodyTemplate::build(io::read_mesh(o.mesh), o.scale);
    for (const std::string& sentence : shape->report().sentences()) std::fprintf(stderr, "supple: %s: %s\n", o.mesh.c_str(), sentence.c_str());
    const BodyId body = world.add_body({.name = o.mesh, .shape = shape, .material = parse_material(o.material), .density_kg_m3 = o.density_kg_m3});
    if (!o.positions.empty()) {
        const std::vector<Vec3> positions = io::read_vectors(o.positions, shape->mesh().vertices.size());
        world.set_state(body, positions, std::vector<Vec3>(positions.size(), Vec3::Zero()));
    }
    const Inspector inspector(world, body);
    if (!o.matrix.empty()) {
        const SystemMatrix which = o.matrix == "mass" ? SystemMatrix::mass : o.matrix == "damping" ? SystemMatrix::damping : SystemMatrix::stiffness;
        io::write_matrix_market(o.out, inspector.matrix(which));
    }
    if (o.element >= 0) {
        std::printf("%s\n", element_object(inspector.element(std::size_t(o.element)), o.element).block().c_str());
        return kAllWell;
    }
    const BoundingBox box = inspector.bounding_box();
    std::printf("%s\n", JsonObject()
                            .add("vertices", json(shape->mesh().vertices.size()))
                            .add("elements", json(inspector.element_count()))
                            .add("rows", json(std::size_t(inspector.rows())))
                            .add("min_m", json(box.min_m))
                            .add("max_m", json(box.max_m))
                            .add("energy_j", number(world.energy().elastic_j))
                            .line()
                            .c_str());
    return kAllWell;
}

}  // namespace

void add_inspect_command(CLI::App& app, int& status) {
    auto o = std::make_shared<InspectOptions>();
    CLI::App* command = app.add_subcommand("inspect", "one element taken apart, or the matrices of a body, in double precision");
    command->add_option("--mesh", o->mesh, "volume mesh in its rest shape")->required();
    command->add_option("--scale", o->scale, "length multiplier of the mesh (not of the positions) [1]")->check(CLI::PositiveNumber);
    command->add_option("--material", o->material, "material as in a scene file [corotational]");
    command->add_option("--positions", o->positions, "deformed positions, x y z a line [m] [the rest shape]");
    command->add_option("--element", o->element, "print this element as JSON: rotations, F, B, D, stiffness, energy, stress")->check(CLI::NonNegativeNumber);
    CLI::Option* matrix = command->add_option("--matrix", o->matrix, "matrix to export: mass, stiffness or damping")->check(CLI::IsMember({"mass", "stiffness", "damping"}));
    CLI::Option* out = command->add_option("--out", o->out, "Matrix Market file of --matrix");
    matrix->needs(out);
    out->needs(matrix);
    command->add_option("--density", o->density_kg_m3, "density [1000 kg/m^3]");
    command->add_option("--rayleigh-mass", o->rayleigh_mass_1_s, "alpha of C = alpha M + beta K [1/s]");
    command->add_option("--rayleigh-stiffness", o->rayleigh_stiffness_s, "beta [s]");
    command->callback([o, &status] { status = inspect(*o); });
}

}  // namespace supple::demos
