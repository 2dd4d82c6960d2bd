//! The Vulkan loader, one instance, and what its validation layer has to say.

use std::{
    ffi::{CStr, c_char, c_void},
    rc::Rc,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use ash::{ext, vk};

use super::error::{GpuError, failed_to};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// What the validation layer says, shared by clones; outlives what it listens to, so that leaks are heard too.
///
/// The layer may speak from any thread.
#[derive(Clone, Debug, Default)]
pub struct ValidationLog(Arc<Mutex<Heard>>);

#[derive(Debug, Default)]
struct Heard {
    listening: bool,
    messages: Vec<String>,
}

impl ValidationLog {
    /// Returns the messages so far, oldest first; none when the layer was never on, because it is not installed.
    pub fn messages(&self) -> Option<Vec<String>> {
        let heard = self.heard();
        heard.listening.then(|| heard.messages.clone())
    }

    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The loaded library and an instance; destroyed with its last owner.
pub(super) struct Instance {
    pub(super) entry: ash::Entry,
    pub(super) handle: ash::Instance,
    validation: Option<Validation>,
}

/// The listener to the validation layer.
struct Validation {
    functions: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    /// Where messages go; the messenger points into it.
    _log: ValidationLog,
}

impl Instance {
    /// Loads Vulkan and makes an instance with the given extensions.
    ///
    /// With a log the validation layer is switched on, if it is installed.
    ///
    /// # Errors
    ///
    /// When there is no loader or no driver.
    pub(super) fn new(extensions: &[*const c_char], log: Option<&ValidationLog>) -> Result<Rc<Self>, GpuError> {
        // SAFETY: the system's Vulkan loader has no requirements on being loaded.
        let entry = unsafe { ash::Entry::load() }.map_err(|e| GpuError::NoLoader(e.to_string()))?;
        let log = log.filter(|_| has_layer(&entry, VALIDATION_LAYER));
        let app = vk::ApplicationInfo::default().application_name(c"walkabout").api_version(vk::API_VERSION_1_3);
        let mut extensions = extensions.to_vec();
        let mut layers = Vec::new();
        if log.is_some() {
            extensions.push(ext::debug_utils::NAME.as_ptr());
            layers.push(VALIDATION_LAYER.as_ptr());
        }
        let checks = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&checks);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&app)
            .enabled_extension_names(&extensions)
            .enabled_layer_names(&layers);
        if log.is_some() {
            info = info.push_next(&mut features);
        }
        // SAFETY: all pointers in `info` are to locals that outlive the call.
        let handle = unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
            vk::Result::ERROR_INCOMPATIBLE_DRIVER => GpuError::NoDriver,
            other => failed_to("start")(other),
        })?;
        // Nothing between here and the messenger can fail, so the handle cannot leak.
        let mut instance = Self { entry, handle, validation: None };
        if let Some(log) = log {
            instance.validation = Some(Validation::listen(&instance, log.clone())?);
        }
        Ok(Rc::new(instance))
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some(v) = &self.validation {
            // SAFETY: the messenger was made from this instance and is destroyed once, before it.
            unsafe { v.functions.destroy_debug_utils_messenger(v.messenger, None) };
        }
        // SAFETY: everything made from the instance holds it by `Rc` and so is gone.
        unsafe { self.handle.destroy_instance(None) };
    }
}

impl Validation {
    fn listen(instance: &Instance, log: ValidationLog) -> Result<Self, GpuError> {
        let functions = ext::debug_utils::Instance::new(&instance.entry, &instance.handle);
        log.heard().listening = true;
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            )
            .message_type(
                vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
            )
            .pfn_user_callback(Some(on_message))
            // The list outlives the messenger: both are fields of `Validation`, and the messenger goes first, in
            // `Instance::drop`.
            .user_data(Arc::as_ptr(&log.0).cast_mut().cast());
        // SAFETY: the extension was enabled, and `on_message` may be called until the messenger is destroyed.
        let messenger = unsafe { functions.create_debug_utils_messenger(&info, None) }
            .map_err(failed_to("listen to its validation layer"))?;
        Ok(Self { functions, messenger, _log: log })
    }
}

/// Collects a message; never prints, because the terminal belongs to somebody else.
unsafe extern "system" fn on_message(
    _: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes a valid structure, and `user` is the list given to the messenger.
    let (data, heard) = unsafe { (&*data, &*user.cast_const().cast::<Mutex<Heard>>()) };
    // SAFETY: the layer's text is a C string or null, which ash turns into `None`.
    let text = unsafe { data.message_as_c_str() }.map_or_else(String::new, |t| t.to_string_lossy().into_owned());
    heard.lock().unwrap_or_else(PoisonError::into_inner).messages.push(text);
    vk::FALSE
}

fn has_layer(entry: &ash::Entry, name: &CStr) -> bool {
    // SAFETY: the entry is loaded; the call has no other requirement.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }.unwrap_or_default();
    layers.iter().any(|l| l.layer_name_as_c_str() == Ok(name))
}
