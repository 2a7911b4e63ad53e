#include "supple/io/scene_parts.h"

namespace supple::io {

void read_probes(const JsonNode& node, SceneBody& body) {
    if (!node.has("probes")) return;
    for (const JsonNode& entry : node.at("probes").items()) {
        require_keys(entry, with_selection_keys({"name", "threshold_pa", "threshold_m", "strain"}));
        ProbeDef probe;
        probe.where = read_selection(entry, body.def.shape->mesh());
        probe.name = entry.has("name") ? entry.at("name").text() : "probe " + std::to_string(body.probes.size());
        if (entry.has("threshold_pa")) probe.threshold_pa = entry.at("threshold_pa").number_above(0, 1e15);
        if (entry.has("threshold_m")) probe.threshold_m = entry.at("threshold_m").number_above(0, 1e9);
        if (entry.has("strain")) {
            probe.strain = entry.at("strain").choice({"corotational", "green"}) == "green" ? StrainMeasure::green : StrainMeasure::corotational;
        }
        body.probes.push_back(std::move(probe));
    }
}

}  // namespace supple::io
