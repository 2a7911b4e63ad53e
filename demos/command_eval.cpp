#include <cstdio>
#include <memory>

#include "command.h"
#include "json_text.h"
#include "material_option.h"
#include "output_files.h"
#include "stress_options.h"
#include "supple/base/error.h"
#include "supple/io/mesh_file.h"
#include "supple/io/text_files.h"
#include "supple/world/evaluate.h"
#include "supple/world/self_test.h"

namespace supple::demos {
namespace {

struct EvalOptions {
    std::string mesh, material, positions, forces, direction, dforces;
    std::string tangent;  ///< empty = the one that the law has
    double scale = 1;
    StressOptions stress;
    bool self_test = false;
};

/// Corotational laws have two tangents; the others are differentiated fully. Linear: both are the same.
void check_tangent(const std::string& tangent, const Material& material) {
    if (tangent == "warped" && is_hyperelastic(material))
        throw Error(ErrorCode::unsupported, "--tangent warped", "a hyperelastic law has no rotation to hold: use exact, its consistent tangent");
}

/// Forces against energies and tangents against forces, by differences.
int self_test(const Material& material) {
    const DerivativeCheck check = check_derivatives(material);
    std::printf("%s\n", JsonObject()
                            .add("passed", check.passed() ? "true" : "false")
                            .add("samples", json(check.samples))
                            .add("force_error", check.has_energy ? json(check.force_error) : "null")
                            .add("tangent_error", json(check.tangent_error))
                            .add("tangent", json(std::string_view(check.tangent)))
                            .line()
                            .c_str());
    return check.passed() ? kAllWell : kRunFailed;
}

int eval(const EvalOptions& o) {
    if (o.self_test) return self_test(parse_material(o.material));
    if (o.mesh.empty() || o.positions.empty()) throw Error(ErrorCode::invalid_argument, "supple eval", "needs --mesh and --positions, or --self-test");
    o.stress.check();
    require_writable(o.forces);
    require_writable(o.dforces);
    const Material material = parse_material(o.material);
    check_tangent(o.tangent, material);
    const auto shape = BodyTemplate::build(io::read_mesh(o.mesh), o.scale);
    for (const std::string& sentence : shape->report().sentences()) std::fprintf(stderr, "supple: %s: %s\n", o.mesh.c_str(), sentence.c_str());
    const std::size_t vertices = shape->mesh().vertices.size();
    const std::vector<Vec3> positions = io::read_vectors(o.positions, vertices);

    const Evaluation result = evaluate(*shape, material, positions);
    if (!o.forces.empty()) io::write_vectors(o.forces, result.forces_n);
    if (!o.direction.empty())
        io::write_vectors(o.dforces, force_differential(*shape, material, positions, io::read_vectors(o.direction, vertices),
                                                        o.tangent == "exact" ? Tangent::exact : Tangent::automatic));
    if (!o.stress.file.empty()) io::write_stress(o.stress.file, evaluate_stress(*shape, material, positions, o.stress.def()).cauchy_pa);
    std::printf("%s\n", JsonObject()
                            .add("energy_j", json(result.energy_j))
                            .add("vertices", json(vertices))
                            .add("elements", json(shape->mesh().element_count()))
                            .line()
                            .c_str());
    return kAllWell;
}

}  // namespace

void add_eval_command(CLI::App& app, int& status) {
    auto o = std::make_shared<EvalOptions>();
    CLI::App* command = app.add_subcommand("eval", "forces, energy and stress of a given configuration, in double precision");
    command->add_option("--mesh", o->mesh, "volume mesh in its rest shape");
    command->add_option("--scale", o->scale, "length multiplier of the mesh (not of the positions) [1]")->check(CLI::PositiveNumber);
    command->add_option("--material", o->material, "material as in a scene file, e.g. '{\"law\": \"corotational\", \"young_pa\": 1e5}'")->required();
    command->add_option("--positions", o->positions, "deformed positions, x y z a line [m]");
    command->add_option("--forces", o->forces, "write the internal force per vertex [N], towards rest");
    CLI::Option* direction = command->add_option("--direction", o->direction, "displacement per vertex [m] for --dforces");
    CLI::Option* dforces = command->add_option("--dforces", o->dforces, "write the force differential (df/dx) d [N]");
    direction->needs(dforces);
    dforces->needs(direction);
    command->add_option("--tangent", o->tangent, "tangent of --dforces: warped (corotational, linear) or exact (all but rotation large) [warped for corotational, exact for hyperelastic]")->check(CLI::IsMember({"warped", "exact"}))->needs(dforces);
    o->stress.add(*command);
    command->add_flag("--self-test", o->self_test, "check the derivatives of the material by differences instead; needs --material alone");
    command->callback([o, &status] { status = eval(*o); });
}

}  // namespace supple::demos
