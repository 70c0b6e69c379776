import './style/main.css';
import { Shell } from './shell';
import { applyTheme, currentTheme } from './ui/theme';

applyTheme(currentTheme());
const app = document.getElementById('app');
if (app) new Shell(app).start();
