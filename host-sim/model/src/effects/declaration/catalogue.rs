//! The macro that generates the catalogue from the list of effects.

/// Declares [`Effect`](super::super::Effect) with the methods of [`EffectModel`](super::EffectModel), and
/// [`KINDS`](super::super::KINDS), from the list of the types that implement this trait.
macro_rules! catalogue {
    ($($variant:ident),+ $(,)?) => {
        /// An effect with its parameters: an entry `[[axis.NAME.effect]]` of a machine file.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Effect { $(
            #[doc = concat!("See [`", stringify!($variant), "`].")]
            $variant($variant),
        )+ }

        /// Declarations of all kinds of effects, in catalogue order.
        pub const KINDS: &[Kind] = &[$(Kind {
            name: $variant::NAME,
            summary: $variant::SUMMARY,
            distinguishing_key: $variant::DISTINGUISHING_KEY,
            special_form_of: $variant::SPECIAL_FORM_OF,
            is_linear: $variant::IS_LINEAR,
            needs_force: $variant::NEEDS_FORCE,
            reads_temperature: $variant::READS_TEMPERATURE,
            drives: $variant::DRIVES,
            contains: $variant::CONTAINS,
            part_of_declared: $variant::PART_OF_DECLARED,
            parameters: $variant::PARAMETERS,
            named_keys: $variant::NAMED_KEYS,
            optional_named_keys: $variant::OPTIONAL_NAMED_KEYS,
            occurrence: $variant::OCCURRENCE,
            shown_in: $variant::SHOWN_IN,
            draw_number: $variant::DRAW_NUMBER,
            prerequisite: $variant::prerequisite,
            draw: |draw| $variant::draw(draw).map(Effect::$variant),
            hides_friction: || $variant::hides_friction().map(Effect::$variant),
            assumed: || $variant::assumed().into_iter().map(Effect::$variant).collect(),
            in_place_of: |found| {
                let Substitute { effect, beside } = $variant::in_place_of(found)?;
                Some(Substitute { effect: Effect::$variant(effect), beside })
            },
        }),+];

        impl Effect {
            /// An effect that another kind declares; `None` if its kind is not in the catalogue.
            fn of_any(any: &AnyEffect) -> Option<Self> {
                $(if let Some(effect) = any.get::<$variant>() {
                    return Some(Self::$variant(effect.clone()));
                })+
                None
            }

            /// Name in files and results.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $variant::NAME,)+ }
            }

            /// Its declaration.
            #[must_use]
            pub fn kind(&self) -> &'static Kind {
                let same_name = |kind: &&Kind| kind.name == self.name();
                let key = match self { $(Self::$variant(_) => $variant::DISTINGUISHING_KEY,)+ };
                let mut kinds = KINDS.iter().filter(same_name);
                // Every variant has its entry in the list.
                kinds.find(|kind| kind.distinguishing_key == key).unwrap_or(&KINDS[0])
            }

            /// The declaration of each value, in the order of [`Effect::values`].
            #[must_use]
            pub fn declared_parameters(&self) -> Vec<&'static Parameter> {
                let (parameters, lengths) = match self {
                    $(Self::$variant(e) => ($variant::PARAMETERS, e.lengths()),)+
                };
                let of_each = parameters.iter().zip(lengths);
                of_each.flat_map(|(parameter, length)| std::iter::repeat_n(parameter, length)).collect()
            }

            /// Whether an axis may have the effect more than once.
            #[must_use]
            pub fn occurrence(&self) -> Occurrence {
                match self { $(Self::$variant(_) => $variant::OCCURRENCE,)+ }
            }

            /// See [`EffectModel::misplaced`].
            #[must_use]
            pub fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
                match self { $(Self::$variant(e) => e.misplaced(place),)+ }
            }

            /// The stages whose residual the effect changes.
            #[must_use]
            pub fn stages(&self) -> &'static [Stage] {
                match self { $(Self::$variant(e) => e.stages(),)+ }
            }

            /// The coordinates to fit.
            #[must_use]
            pub fn coordinates(&self) -> Vec<Coordinate> {
                match self { $(Self::$variant(e) => e.coordinates(),)+ }
            }

            /// The coordinates to fit on an axis with these loop rates.
            #[must_use]
            pub fn coordinates_at(&self, rates: Rates) -> Vec<Coordinate> {
                match self { $(Self::$variant(e) => e.coordinates_at(rates),)+ }
            }

            /// This effect with other values of the coordinates.
            #[must_use]
            pub fn at(&self, x: &[f64]) -> Self {
                match self { $(Self::$variant(e) => Self::$variant(e.at(x)),)+ }
            }

            /// See [`EffectModel::exceeds_tolerance`].
            #[must_use]
            pub fn exceeds_tolerance(&self, declared: &Settings, rates: Rates) -> bool {
                match self { $(Self::$variant(e) => e.exceeds_tolerance(declared, rates),)+ }
            }

            /// See [`EffectModel::imitations`].
            #[must_use]
            pub fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
                match self { $(Self::$variant(e) => e.imitations(context),)+ }
            }

            /// See [`EffectModel::added_with`].
            #[must_use]
            pub fn added_with(&self) -> Option<Self> {
                match self { $(Self::$variant(e) => e.added_with().and_then(|any| Self::of_any(&any)),)+ }
            }

            /// See [`EffectModel::at_its_limit`].
            #[must_use]
            pub fn at_its_limit(&self) -> Option<Self> {
                match self { $(Self::$variant(e) => e.at_its_limit().map(Self::$variant),)+ }
            }

            /// See [`EffectModel::variation`].
            #[must_use]
            pub fn variation(&self, residual: &dyn Fn() -> ResidualShape, travel_mm: [f64; 2]) -> Option<Self> {
                match self { $(Self::$variant(e) => e.variation(residual, travel_mm).and_then(|any| Self::of_any(&any)),)+ }
            }

            /// See [`EffectModel::refined`].
            #[must_use]
            pub fn refined(&self, residual: &dyn Fn() -> ResidualShape) -> Option<Self> {
                match self { $(Self::$variant(e) => e.refined(residual).map(Self::$variant),)+ }
            }

            /// See [`EffectModel::among_several`].
            #[must_use]
            pub fn among_several(&self) -> Option<Self> {
                match self { $(Self::$variant(e) => e.among_several().map(Self::$variant),)+ }
            }

            /// See [`EffectModel::other_starts`].
            #[must_use]
            pub fn other_starts(&self) -> Vec<Self> {
                match self { $(Self::$variant(e) => e.other_starts().into_iter().map(Self::$variant).collect(),)+ }
            }

            /// See [`EffectModel::other_form`].
            #[must_use]
            pub fn other_form(&self) -> Option<Self> {
                match self { $(Self::$variant(e) => e.other_form().map(Self::$variant),)+ }
            }

            /// See [`EffectModel::prior`].
            #[must_use]
            pub fn prior(&self, declared: &Settings) -> Option<[f64; 2]> {
                match self { $(Self::$variant(e) => e.prior(declared),)+ }
            }

            /// See [`EffectModel::describes_any_shape_of`].
            #[must_use]
            pub fn describes_any_shape_of(&self) -> Option<Stage> {
                match self { $(Self::$variant(e) => e.describes_any_shape_of(),)+ }
            }

            /// See [`EffectModel::depends_on_direction`].
            #[must_use]
            pub fn depends_on_direction(&self) -> bool {
                match self { $(Self::$variant(e) => e.depends_on_direction(),)+ }
            }

            /// See [`EffectModel::wave`].
            #[must_use]
            pub fn wave(&self) -> Option<PeriodicError> {
                match self { $(Self::$variant(e) => e.wave(),)+ }
            }

            /// See [`EffectModel::leaves`].
            #[must_use]
            pub fn leaves(&self, wave: PeriodicError) -> bool {
                match self { $(Self::$variant(e) => e.leaves(wave),)+ }
            }

            /// See [`EffectModel::of_scale`].
            #[must_use]
            pub fn of_scale(&self) -> Option<Self> {
                match self { $(Self::$variant(e) => e.of_scale().and_then(|any| Self::of_any(&any)),)+ }
            }

            /// See [`EffectModel::slope`].
            #[must_use]
            pub fn slope(&self) -> Option<SlopeOf> {
                match self { $(Self::$variant(e) => e.slope(),)+ }
            }

            /// See [`EffectModel::mode`].
            #[must_use]
            pub fn mode(&self) -> Option<Mode> {
                match self { $(Self::$variant(e) => e.mode(),)+ }
            }

            /// See [`EffectModel::timing`].
            #[must_use]
            pub fn timing(&self) -> Option<Timing> {
                match self { $(Self::$variant(e) => e.timing(),)+ }
            }

            /// See [`EffectModel::within_logs`].
            #[must_use]
            pub fn within_logs(&self, half_widths: &[f64], end_s: f64) -> Option<Self> {
                match self { $(Self::$variant(e) => e.within_logs(half_widths, end_s).and_then(|any| Self::of_any(&any)),)+ }
            }

            /// See [`EffectModel::over_position`].
            #[must_use]
            pub fn over_position(&self) -> Option<&[f64]> {
                match self { $(Self::$variant(e) => e.over_position(),)+ }
            }

            /// See [`EffectModel::compensation`].
            #[must_use]
            pub fn compensation(&self) -> EffectCompensation {
                match self { $(Self::$variant(e) => e.compensation(),)+ }
            }

            /// Values of the parameters, those of a list one after the other.
            #[must_use]
            pub fn values(&self) -> Vec<f64> {
                match self { $(Self::$variant(e) => e.values(),)+ }
            }

            /// The property that distinguishes effects of the same name on one axis.
            #[must_use]
            pub fn distinction(&self) -> Distinction<'_> {
                match self { $(Self::$variant(e) => e.distinction(),)+ }
            }

            /// The variable over which the residual is plotted.
            #[must_use]
            pub fn abscissa(&self) -> Abscissa {
                match self { $(Self::$variant(e) => e.abscissa(),)+ }
            }

            /// Description of the effect with its values and the half widths of their confidence intervals. Missing
            /// half widths are omitted.
            #[must_use]
            pub fn sentence(&self, half_widths: &[f64], is_rotary: bool) -> String {
                let wording = Wording::new(self.declared_parameters(), self.values(), half_widths, is_rotary);
                match self { $(Self::$variant(e) => e.sentence(&wording),)+ }
            }
        }

        /// Every initial guess of every effect that the context and the drive of the axis allow.
        #[must_use]
        pub fn initial_guesses(context: &EffectContext<'_>) -> Vec<Effect> {
            let mut all = Vec::new();
            $(if $variant::DRIVES.contains(&context.axis.controller.drive) {
                all.extend($variant::initial_guesses(context).into_iter().map(Effect::$variant));
            })+
            all
        }

        impl Serialize for Effect {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                #[derive(Serialize)]
                struct Named<'a, T> {
                    name: &'static str,
                    #[serde(flatten)]
                    effect: &'a T,
                }
                let name = self.name();
                match self { $(Self::$variant(effect) => Named { name, effect }.serialize(serializer),)+ }
            }
        }

        impl<'de> Deserialize<'de> for Effect {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let mut keys = BTreeMap::<String, EntryValue>::deserialize(deserializer)?;
                let Some(EntryValue::Text(name)) = keys.remove("name") else {
                    return Err(de::Error::missing_field("name"));
                };
                let is_distinguished = |kind: &&Kind| kind.distinguishing_key.is_some_and(|key| keys.contains_key(key));
                let kinds = KINDS.iter().filter(|kind| kind.name == name);
                let distinguishing_key = kinds.clone().find(is_distinguished).and_then(|kind| kind.distinguishing_key);
                let values = MapDeserializer::new(keys.into_iter());
                $(if name == $variant::NAME && $variant::DISTINGUISHING_KEY == distinguishing_key {
                    return $variant::deserialize(values).map(Self::$variant);
                })+
                Err(de::Error::unknown_variant(&name, &[$($variant::NAME),+]))
            }
        }

        /// Declaration of one kind of effect; see [`EffectModel`].
        pub struct Kind {
            /// [`EffectModel::NAME`].
            pub name: &'static str,
            /// [`EffectModel::SUMMARY`].
            pub summary: &'static str,
            /// [`EffectModel::DISTINGUISHING_KEY`].
            pub distinguishing_key: Option<&'static str>,
            /// [`EffectModel::SPECIAL_FORM_OF`].
            pub special_form_of: Option<&'static str>,
            /// [`EffectModel::IS_LINEAR`].
            pub is_linear: bool,
            /// [`EffectModel::NEEDS_FORCE`].
            pub needs_force: bool,
            /// [`EffectModel::READS_TEMPERATURE`].
            pub reads_temperature: bool,
            /// [`EffectModel::DRIVES`].
            pub drives: &'static [Drive],
            /// [`EffectModel::CONTAINS`].
            pub contains: &'static [&'static str],
            /// [`EffectModel::PART_OF_DECLARED`].
            pub part_of_declared: &'static [&'static str],
            /// [`EffectModel::PARAMETERS`].
            pub parameters: &'static [Parameter],
            /// [`EffectModel::NAMED_KEYS`].
            pub named_keys: &'static [(&'static str, &'static str)],
            /// [`EffectModel::OPTIONAL_NAMED_KEYS`].
            pub optional_named_keys: &'static [(&'static str, &'static str)],
            /// [`EffectModel::OCCURRENCE`].
            pub occurrence: Occurrence,
            /// [`EffectModel::SHOWN_IN`].
            pub shown_in: &'static [Stage],
            /// [`EffectModel::DRAW_NUMBER`].
            pub draw_number: Option<u32>,
            /// [`EffectModel::prerequisite`].
            pub prerequisite: fn(&Settings, Neighbours) -> Prerequisite,
            /// [`EffectModel::draw`].
            pub draw: fn(&mut Draw<'_>) -> Option<Effect>,
            /// [`EffectModel::hides_friction`].
            pub hides_friction: fn() -> Option<Effect>,
            /// [`EffectModel::assumed`].
            pub assumed: fn() -> Vec<Effect>,
            /// [`EffectModel::in_place_of`].
            pub in_place_of: fn(&Found<'_>) -> Option<Substitute<Effect>>,
        }

        /// Names of all effects, in catalogue order, each once.
        #[must_use]
        pub fn names() -> Vec<&'static str> {
            KINDS.iter().filter(|kind| kind.distinguishing_key.is_none()).map(|kind| kind.name).collect()
        }

        impl Effect {
            /// Key and value of each parameter; of a list, each value with its key.
            #[must_use]
            pub fn parameters(&self) -> Vec<(&'static str, f64)> {
                self.declared_parameters().iter().map(|parameter| parameter.key).zip(self.values()).collect()
            }

            /// Whether both are of one kind.
            #[must_use]
            pub fn is_same_kind(&self, other: &Self) -> bool {
                std::mem::discriminant(self) == std::mem::discriminant(other)
            }

            /// Whether both are the same effect of an axis, regardless of the values.
            #[must_use]
            pub fn is_same(&self, other: &Self) -> bool {
                self.name() == other.name() && self.distinction() == other.distinction()
            }
        }
    };
}

pub(in crate::effects) use catalogue;
