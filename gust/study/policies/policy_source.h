#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gust/agents/agent.h"
#include "gust/control/policy.h"
#include "gust/onnx/data.h"
#include "gust/setup/setup.h"

namespace gust {

/// A file that a study names.
struct StudyFile {
  std::string path;  ///< as the study's pattern found it
  std::string bytes;
  OnnxData data = {};  ///< the files beside an ONNX file that hold its weights; they are part of what the policy is
};

/// Finds and reads the files of a pattern such as "policies/*.onnx", sorted by path.
using FindFiles = std::function<std::vector<StudyFile>(const std::string& pattern, const Place& place)>;

/// What a policy is made for, and where it is written.
struct PolicyContext {
  const Setup& setup;
  const FindFiles& find;
  Place place;  ///< of the [[policy]]

  const Interface& spec() const { return setup.plant->spec(); }
  /// The equations of motion; an Error that names what needs them if the setup has none.
  const Plant& equations(std::string_view what) const { return setup.equations(what, place); }
};

/// What has to be trained before there are policies: one training a seed.
struct PolicyTraining {
  Made<Agent> agent;
  std::vector<std::int64_t> seeds;
  std::vector<Injection> disturbed;  ///< on during training
  Randomisation randomised;          ///< parameters sampled in training
  bool curve_as_trained = false;     ///< its learning curve has them, and is disturbed
};

/// One of the policies that share a name, with the training that it comes from.
struct PolicyMember {
  std::size_t index = 0;
  std::string training = {};  ///< id of that training; empty where nothing is trained
  std::string network = {};   ///< the bytes of the network that it ended with; for make()
};

/// Where policies come from: one [[policy]] of a study, or what `gust eval` was given. The keys are read first, then
/// prepare() is called once; after that it never changes.
class PolicySource {
 public:
  virtual ~PolicySource() = default;

  /// Reads and checks what depends on the plant or on files. What the user can mend is an Error with its place.
  virtual void prepare(const PolicyContext&) {}

  /// What a member is, without its name: equal texts make equal policies, which share their trials. It begins with the
  /// kind, or with the id of the training, and every line ends. Never changed for what results are stored of.
  virtual std::string canonical(const PolicyMember& member) const = 0;

  /// Which policies share the name: training seeds or files; one empty text for a policy that stands alone.
  virtual std::vector<std::string> members() const { return {""}; }

  /// What has to be trained first; null if nothing has to be. Its seeds are then the members.
  virtual const PolicyTraining* training() const { return nullptr; }

  /// Whether it was made by another program, so that order, signs and units of its numbers may be mistaken.
  virtual bool foreign() const { return false; }

  /// What the user should know before anything runs, one sentence each.
  virtual std::vector<std::string> warnings() const { return {}; }

  /// A policy for the plant of the setup. Each call gives one of its own: a Policy belongs to one thread.
  virtual std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember& member) const = 0;
};

/// One kind of policy, as the catalogue has it.
struct PolicyKind {
  std::string name;
  std::string summary;
  std::string source;   ///< where it is defined: a paper, a section of docs/, or gust itself
  std::string example;  ///< a [[policy]] of a study
  std::vector<FieldInfo> fields;
  std::string file_ending;  ///< of the files that are such policies, ".onnx"; empty if files are not
  bool trained = false;     ///< whether it has to be trained before it acts
  /// Reads a table whose keys "name" and "kind" are ignored. Throws Error.
  std::function<std::shared_ptr<const PolicySource>(const Table&, const PolicyContext&)> read;
};

/// Every kind of policy there is, in the order of list.inc.
const std::vector<PolicyKind>& policy_kinds();
std::vector<std::string> policy_kind_names();

/// The kind of a name; an unknown one is an Error at the place, with the nearest name.
const PolicyKind& policy_kind(std::string_view name, const Place& place);

}  // namespace gust
