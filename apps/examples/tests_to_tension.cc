// A campaign of two tests: EI at several tensions from bending tests, and natural frequencies of
// the same cable in its scene -> the cable's tension with its uncertainty, to which that of EI
// adds.
//   tests_to_tension SCENE.toml TENSION_N FREQUENCY_HZ... -- TENSION_N,EI_NM2,STD_NM2...
// TENSION_N is what the load cell says, within 5 %; frequencies are of in-plane modes of a member
// named "cable", known to 0.1 %.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "ident/campaign/campaign.h"
#include "model/scene/read_scene.h"

int main(int argc, char** argv) try {
  using namespace rigfit;
  if (argc < 6) {
    std::fprintf(stderr,
                 "usage: tests_to_tension SCENE TENSION FREQUENCY... -- TENSION,EI,STD...\n");
    return 2;
  }
  const double read_N = std::atof(argv[2]);
  ident::BendingSource bending;
  ident::ModalInputs hits;
  hits.name = "cable";
  hits.setup.plane = model::ModePlane::in;
  hits.scene = ident::SceneUse{model::read_scene(argv[1]), {"cable.tension"}, {"cable.EI"}, {}, {}};
  for (int k = 3; k < argc; ++k) {
    ident::StiffnessPoint point;
    if (std::sscanf(argv[k], "%lf,%lf,%lf", &point.tension_N, &point.EI_Nm2, &point.std) == 3) {
      bending.values.push_back(point);
    } else if (std::atof(argv[k]) > 0) {
      hits.published.push_back({read_N, std::atof(argv[k]), {}});
    }
  }
  ident::CampaignInputs campaign;
  ident::BendingCampaign bent;
  bent.sources.push_back(bending);
  campaign.tests = {bent, hits};

  ident::FitInputs fit;
  fit.tests = {1};
  fit.free.push_back({.name = "cable.tension", .prior = signal::Estimate{read_N, 0.05 * read_N}});
  fit.options.assumed_relative_std = 1e-3;
  campaign.fits.push_back(fit);

  const ident::CampaignResult result = ident::run_campaign(campaign);
  std::printf("EI at %g N: %.4f N m2 (%s)\n", read_N, result.known.EI.at(read_N).EI_Nm2,
              result.known.EI.sentence().c_str());
  const ident::UpdateResult& found = result.fits[0].result;
  for (const auto& parameter : found.parameters) {
    std::printf("%s: %.2f N (std %.2g)\n", parameter.name.c_str(), parameter.value, parameter.std);
    for (const auto& term : parameter.budget) {
      std::printf("  of it %.2g by %s\n", term.std, term.source.c_str());
    }
  }
  for (const auto& finding : result.fits[0].findings) {
    std::printf("%s\n", finding.message.c_str());
  }
  return found.status == ident::UpdateStatus::converged ? 0 : 5;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
