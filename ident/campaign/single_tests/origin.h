// Source of a value of a campaign.
#pragma once

namespace rigfit::ident {

enum class Origin {
  measured,         ///< from recordings of this campaign
  published,        ///< a measurement that was published
  published_model,  ///< a model's result that was published
  synthetic,        ///< from recordings of the virtual laboratory
  modelled,         ///< computed by rigfit
};

}  // namespace rigfit::ident
